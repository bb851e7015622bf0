use super::super::fixture::compensator;
use super::*;

/// The file with its envelope changed by `edit`.
fn with_envelope(bytes: &[u8], edit: impl Fn(&str) -> String) -> Vec<u8> {
    let (_, metadata) = SafeTensors::read_metadata(bytes).unwrap();
    let envelope = edit(&metadata.metadata().as_ref().unwrap()[KEY]);
    let file = SafeTensors::deserialize(bytes).unwrap();
    let metadata = Some([(KEY.to_owned(), envelope)].into_iter().collect());
    safetensors::serialize(file.tensors(), metadata).unwrap()
}

#[test]
fn what_is_read_is_what_was_written_and_writing_is_repeatable() {
    let c = compensator();
    let bytes = c.to_bytes().unwrap();
    assert_eq!(bytes, c.to_bytes().unwrap());
    assert_eq!(Compensator::from_bytes(&bytes).unwrap(), c);
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("compensator.safetensors");
    c.save(&path).unwrap();
    assert_eq!(Compensator::load(&path).unwrap(), c);
    assert_eq!(
        std::fs::read_dir(directory.path()).unwrap().count(),
        1,
        "no temporary file stays"
    );
}

#[test]
fn a_file_cut_anywhere_is_refused() {
    let bytes = compensator().to_bytes().unwrap();
    for end in (0..bytes.len()).step_by(97).chain([bytes.len() - 1]) {
        let error = Compensator::from_bytes(&bytes[..end]).unwrap_err();
        assert!(
            matches!(error, Error::Container(_)),
            "cut at {end}: {error}"
        );
    }
}

#[test]
fn a_changed_weight_is_refused() {
    let bytes = compensator().to_bytes().unwrap();
    let start = 8 + u64::from_le_bytes(bytes[..8].try_into().unwrap()) as usize;
    for at in (start..bytes.len()).step_by(61) {
        let mut altered = bytes.clone();
        altered[at] ^= 0x10;
        let error = Compensator::from_bytes(&altered).unwrap_err();
        assert!(
            matches!(error, Error::Checksum { .. }),
            "byte {at}: {error}"
        );
    }
}

#[test]
fn a_changed_header_is_refused() {
    let bytes = compensator().to_bytes().unwrap();
    let swapped = with_envelope(&bytes, |e| e.replace("elbow", "wrist"));
    assert!(matches!(
        Compensator::from_bytes(&swapped),
        Err(Error::Checksum { .. })
    ));
    let other = with_envelope(&bytes, |e| e.replace("\"version\":1", "\"version\":2"));
    assert!(matches!(
        Compensator::from_bytes(&other),
        Err(Error::Version {
            found: 2,
            supported: 1
        })
    ));
    let foreign = with_envelope(&bytes, |e| e.replace(FORMAT, "somebody/else"));
    assert!(matches!(
        Compensator::from_bytes(&foreign),
        Err(Error::NotACompensator(_))
    ));
    let plain =
        safetensors::serialize(SafeTensors::deserialize(&bytes).unwrap().tensors(), None).unwrap();
    assert!(matches!(
        Compensator::from_bytes(&plain),
        Err(Error::NotACompensator(_))
    ));
}

#[test]
fn another_robot_and_other_inputs_are_refused() {
    let c = compensator();
    let names = |names: &[&str]| names.iter().map(|n| n.to_string()).collect::<Vec<_>>();
    assert!(c.check_joints(&names(&["shoulder", "elbow"])).is_ok());
    assert!(matches!(
        c.check_joints(&names(&["elbow", "shoulder"])),
        Err(Error::Joints { .. })
    ));
    assert!(matches!(
        c.check_joints(&names(&["shoulder"])),
        Err(Error::Joints { .. })
    ));
    assert!(matches!(
        c.check_inputs(&names(&["q1"])),
        Err(Error::Inputs { .. })
    ));
}

#[test]
fn a_unit_that_contradicts_itself_is_not_written() {
    let mut c = compensator();
    c.units[1].members[0].pop();
    assert!(matches!(c.to_bytes(), Err(Error::Unit { unit: 1, .. })));
    let mut c = compensator();
    c.units[0].members[1][3] = f32::NAN;
    assert!(matches!(c.to_bytes(), Err(Error::Unit { unit: 0, .. })));
    let mut c = compensator();
    c.units[2].columns[0] = 9;
    assert!(matches!(c.to_bytes(), Err(Error::Unit { unit: 2, .. })));
}

#[test]
fn the_form_of_the_weights_is_stored_and_single_precision_is_left_unsaid() {
    let mut c = compensator();
    let plain = c.to_bytes().unwrap();
    assert!(!String::from_utf8_lossy(&plain).contains("weights\\"));
    c.units[1].weights = Weights::Int8;
    let bytes = c.to_bytes().unwrap();
    assert_eq!(Compensator::from_bytes(&bytes).unwrap(), c);
}
