//! Robots whose drives are known from recipes in the repository.

/// Parts of robot names, lower case, and the text of the recipe that describes their drives.
const KNOWN: [(&[&str], &str); 4] = [
    (
        &["so101", "so_101", "so-101", "so100", "so_arm"],
        include_str!("../../recipes/replay/so101.toml"),
    ),
    (
        &["koch", "low_cost", "omx"],
        include_str!("../../recipes/replay/koch.toml"),
    ),
    (&["z1"], include_str!("../../recipes/replay/z1.toml")),
    (&["piper"], include_str!("../../recipes/replay/piper.toml")),
];

/// Text of the block `[controller]` from the recipe of a robot of this name, with gains for `joints` joints. None where
/// there is no recipe.
pub(crate) fn controller(robot: &str, joints: usize) -> Option<String> {
    let name = robot.to_lowercase();
    let known = |(parts, _): &&(&[&str], &str)| parts.iter().any(|p| name.contains(p));
    let (_, recipe) = KNOWN.iter().find(known)?;
    let lines = recipe.lines().map(|line| line.trim_start_matches("# "));
    let block = lines.skip_while(|line| *line != "[controller]");
    let block: Vec<String> = block.map(|line| resized(line, joints)).collect();
    Some(block.join("\n"))
}

/// Line of a recipe with its list of gains cut or extended to one value for each joint. The last value is repeated, as
/// the description may count a gripper. Other lines stay as they are.
fn resized(line: &str, joints: usize) -> String {
    match line.split_once(" = [") {
        Some((key, list)) if key.starts_with('k') => {
            let mut values: Vec<&str> = list.trim_end_matches(']').split(", ").collect();
            let last = *values.last().expect("a split has a part");
            values.resize(joints, last);
            format!("{key} = [{}]", values.join(", "))
        }
        _ => line.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use physics::robot::Robot;
    use physics::robot::drive::Drive;

    #[test]
    fn every_recipe_has_a_block_that_can_be_read() {
        let robot = Robot::builtin("ur5").expect("built in");
        for (parts, _) in KNOWN {
            let block = controller(&parts[0].to_uppercase(), 6).expect("it is known");
            assert!(block.starts_with("[controller]\nkind = "), "{block}");
            let drive = Drive::from_toml(&block, &robot).expect("it can be read");
            assert!(drive.controller.is_some());
        }
        let z1 = controller("z1_description", 7).expect("it is known");
        assert!(z1.contains("kp = [80, 120, 120, 80, 80, 80, 80]\n"), "{z1}");
        assert_eq!(controller("ur5", 6), None);
    }
}
