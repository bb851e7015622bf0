//! Changes of a URDF's text that its inertials and friction coefficients do not hold: how the base stands, and where
//! joints are zero.

use super::patched::Patched;
use crate::error::DiagnoseError;
use nalgebra::{Isometry3, Matrix3, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};
use physics::robot::{Robot, RobotError, urdf_with};
use roxmltree::{Document, Node};

/// `urdf` with the robot's numbers, its base turned and its zeros moved (`zeros`, rad or m: q_true = q + zero).
///
/// The base frame stays the world's: a base that is tilted by R stands as the first joint's origin turned by R.
pub(super) fn written(
    urdf: &str,
    patched: &Patched,
    zeros: &[f64],
) -> Result<String, DiagnoseError> {
    let mut text = urdf_with(urdf, &patched.robot)?;
    let given = Robot::from_urdf_str(urdf)?;
    for (j, joint) in given.joints().iter().enumerate() {
        let moves = zeros[j] != 0.0;
        let turns = j == 0 && patched.tilt != Vector3::zeros();
        if !(moves || turns) {
            continue;
        }
        let origin = read_origin(&text, &joint.name)?;
        let mut turned = origin;
        if moves {
            turned *= if joint.kind.is_rotation() {
                let axis = Unit::new_normalize(joint.axis);
                Isometry3::from_parts(
                    Translation3::identity(),
                    UnitQuaternion::from_axis_angle(&axis, zeros[j]),
                )
            } else {
                Isometry3::from(Translation3::from(joint.axis * zeros[j]))
            };
        }
        if turns {
            // What is fixed between the base and the joint's parent: the placement that was read, less the joint's own origin.
            let whole = Isometry3::from_parts(
                joint.translation.into(),
                UnitQuaternion::from_matrix(&joint.rotation),
            );
            let before = whole * origin.inverse();
            let tilt = UnitQuaternion::new(patched.tilt);
            turned = before.inverse() * tilt * before * turned;
        }
        text = with_origin(&text, &joint.name, &turned)?;
    }
    Ok(text)
}

fn find<'a, 'd>(document: &'a Document<'d>, joint: &str) -> Result<Node<'a, 'd>, RobotError> {
    document
        .root_element()
        .children()
        .find(|n| n.has_tag_name("joint") && n.attribute("name") == Some(joint))
        .ok_or_else(|| RobotError::Mismatch {
            what: "joint",
            name: joint.to_owned(),
        })
}

fn parse(urdf: &str) -> Result<Document<'_>, RobotError> {
    Document::parse(urdf).map_err(|e| RobotError::Syntax {
        reason: e.to_string(),
    })
}

fn read_origin(urdf: &str, joint: &str) -> Result<Isometry3<f64>, RobotError> {
    let document = parse(urdf)?;
    let node = find(&document, joint)?;
    let origin = node.children().find(|n| n.has_tag_name("origin"));
    let three = |name: &str| -> Vector3<f64> {
        let text = origin.and_then(|o| o.attribute(name)).unwrap_or_default();
        let mut numbers = text.split_whitespace().filter_map(|x| x.parse().ok());
        Vector3::from_fn(|_, _| numbers.next().unwrap_or(0.0))
    };
    let (xyz, rpy) = (three("xyz"), three("rpy"));
    let rotation = Rotation3::from_euler_angles(rpy.x, rpy.y, rpy.z);
    Ok(Isometry3::from_parts(
        xyz.into(),
        UnitQuaternion::from_rotation_matrix(&rotation),
    ))
}

fn with_origin(urdf: &str, joint: &str, pose: &Isometry3<f64>) -> Result<String, RobotError> {
    let document = parse(urdf)?;
    let node = find(&document, joint)?;
    let t = pose.translation.vector;
    let rotation: Matrix3<f64> = pose.rotation.to_rotation_matrix().into_inner();
    let (roll, pitch, yaw) = Rotation3::from_matrix_unchecked(rotation).euler_angles();
    let element = format!(
        "<origin xyz=\"{} {} {}\" rpy=\"{roll} {pitch} {yaw}\"/>",
        t.x, t.y, t.z
    );
    let mut text = urdf.to_owned();
    match node.children().find(|n| n.has_tag_name("origin")) {
        Some(old) => text.replace_range(old.range(), &element),
        // A moving joint has a parent and a child: there is a first child to stand before.
        None => {
            let at = node
                .first_child()
                .map_or(node.range().end, |c| c.range().start);
            text.insert_str(at, &format!("\n    {element}"));
        }
    }
    Ok(text)
}

#[cfg(test)]
mod tests {
    use super::*;
    use physics::dynamics::{Workspace, inverse_dynamics};

    const ARM: &str = r#"<robot name="arm"><link name="world"/><link name="base"/>
<joint name="mount" type="fixed"><parent link="world"/><child link="base"/><origin xyz="0.1 0 0.5" rpy="0.3 -0.2 0.9"/></joint>
<link name="l1"><inertial><origin xyz="0.1 0 0.05"/><mass value="2"/><inertia ixx="0.02" ixy="0" ixz="0" iyy="0.02" iyz="0" izz="0.02"/></inertial></link>
<joint name="j1" type="revolute"><parent link="base"/><child link="l1"/><origin xyz="0 0.2 0.1" rpy="0 0.4 0"/><axis xyz="0 1 0"/></joint>
<link name="l2"><inertial><origin xyz="0.2 0 0"/><mass value="1"/><inertia ixx="0.01" ixy="0" ixz="0" iyy="0.01" iyz="0" izz="0.01"/></inertial></link>
<joint name="j2" type="revolute"><parent link="l1"/><child link="l2"/><axis xyz="0 0 1"/></joint></robot>"#;

    fn torque(robot: &Robot, q: [f64; 2]) -> [f64; 2] {
        let mut tau = [0.0; 2];
        let mut workspace = Workspace::new(robot);
        inverse_dynamics(
            robot,
            &mut workspace,
            &q,
            &[0.4, -0.3],
            &[1.0, 2.0],
            &mut tau,
        );
        tau
    }

    #[test]
    fn base_and_zeros_are_turned() {
        let robot = Robot::from_urdf_str(ARM).unwrap();
        let patched = Patched {
            robot: robot.clone(),
            tilt: Vector3::new(0.03, -0.05, 0.0),
            causes: &[],
        };
        let zeros = [0.1, -0.2];
        let text = written(ARM, &patched, &zeros).unwrap();
        let found = torque(&Robot::from_urdf_str(&text).unwrap(), [0.5, 0.7]);
        let tilted = robot.with_gravity(patched.gravity());
        let wanted = torque(&tilted, [0.5 + zeros[0], 0.7 + zeros[1]]);
        for (a, b) in found.iter().zip(wanted) {
            assert!((a - b).abs() < 1e-12, "{a} {b}");
        }
    }
}
