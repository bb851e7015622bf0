//! Limits from the robot's description, a file and flags.

use crate::arguments::Arguments;
use identify::excitation::{MotionLimits, Region};
use model::failure::Failure;
use physics::robot::Robot;
use serde::Deserialize;
use std::collections::BTreeMap;
use std::path::Path;

/// Default time to reach full speed, and to reach full acceleration, s.
const TO_SPEED: f64 = 0.5;
const TO_ACCELERATION: f64 = 0.1;

/// Limits of the joints, and their origin.
pub struct Given {
    /// Limits of position, velocity, acceleration and jerk, one entry per joint, before `--share` is applied.
    pub limits: Vec<MotionLimits>,
    /// Whether the limits of acceleration, and of jerk, are assumed values.
    pub assumed: [bool; 2],
    /// The tool's point in the frame of the last joint, m.
    pub tool: [f64; 3],
    /// Regions that the tool's point must not leave.
    pub regions: Vec<Region>,
    /// Pose at the start and end; none where any pose will do.
    pub home: Option<Vec<f64>>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    #[serde(default)]
    all: Joint,
    #[serde(default)]
    joints: BTreeMap<String, Joint>,
    #[serde(default)]
    tool: Tool,
}

#[derive(Clone, Copy, Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Joint {
    lower: Option<f64>,
    upper: Option<f64>,
    velocity: Option<f64>,
    acceleration: Option<f64>,
    jerk: Option<f64>,
}

#[derive(Debug, Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct Tool {
    point: Option<[f64; 3]>,
    #[serde(default)]
    boxes: Vec<Corners>,
    #[serde(default)]
    spheres: Vec<Ball>,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Corners {
    lower: [f64; 3],
    upper: [f64; 3],
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Ball {
    centre: [f64; 3],
    radius: f64,
}

/// Limits of a robot as the command line has them.
pub fn given(robot: &Robot, arguments: &Arguments) -> Result<Given, Failure> {
    let file = match &arguments.limits {
        Some(path) => read(path, robot)?,
        None => File::default(),
    };
    let n = robot.dof();
    let position = each("--position", &arguments.position, n)?;
    let velocity = each("--velocity", &arguments.velocity, n)?;
    let acceleration = each("--acceleration", &arguments.acceleration, n)?;
    let jerk = each("--jerk", &arguments.jerk, n)?;
    let mut assumed = [false; 2];
    let mut limits = Vec::with_capacity(n);
    for (j, (own, joint)) in MotionLimits::of_robot(robot)
        .into_iter()
        .zip(robot.joints())
        .enumerate()
    {
        let named = file.joints.get(&joint.name).copied().unwrap_or_default();
        let filed = |of: fn(&Joint) -> Option<f64>| of(&named).or(of(&file.all));
        let flag = |list: &Option<Vec<f64>>| list.as_ref().map(|l| l[j]);
        let range = position.as_ref().map(|p| p[j]);
        let lower = range
            .map(|r| r[0])
            .or(filed(|l| l.lower))
            .unwrap_or(own.lower);
        let upper = range
            .map(|r| r[1])
            .or(filed(|l| l.upper))
            .unwrap_or(own.upper);
        let velocity = flag(&velocity)
            .or(filed(|l| l.velocity))
            .unwrap_or(own.velocity);
        if !(lower.is_finite() && upper.is_finite()) {
            return Err(Failure::input(
                format!("{} has no range of positions", joint.name),
                "Give --position LO:HI for every joint, or --limits FILE.toml.",
            ));
        }
        if !(velocity.is_finite() && velocity > 0.0) {
            return Err(Failure::input(
                format!("{} has no limit of its speed", joint.name),
                "Give --velocity, or --limits FILE.toml.",
            ));
        }
        let stated = flag(&acceleration).or(filed(|l| l.acceleration));
        assumed[0] |= stated.is_none();
        let acceleration = stated.unwrap_or(velocity / TO_SPEED);
        let stated = flag(&jerk).or(filed(|l| l.jerk));
        assumed[1] |= stated.is_none();
        limits.push(MotionLimits {
            lower,
            upper,
            velocity,
            acceleration,
            jerk: stated.unwrap_or(acceleration / TO_ACCELERATION),
        });
    }
    let mut regions: Vec<Region> = Vec::new();
    regions.extend(&arguments.tool_box);
    regions.extend(&arguments.tool_sphere);
    regions.extend(file.tool.boxes.iter().map(|b| Region::Box {
        lower: b.lower,
        upper: b.upper,
    }));
    regions.extend(file.tool.spheres.iter().map(|s| Region::Sphere {
        centre: s.centre,
        radius: s.radius,
    }));
    if arguments.home.iter().any(|q| !q.is_finite()) {
        return Err(Failure::input("--home has a value that is not finite", ""));
    }
    Ok(Given {
        limits,
        assumed,
        tool: arguments.tool.or(file.tool.point).unwrap_or([0.0; 3]),
        regions,
        home: each("--home", &arguments.home, n)?,
    })
}

/// Values of all joints, from one value for all or one for each; none where none is given.
pub fn each<T: Copy>(flag: &str, values: &[T], joints: usize) -> Result<Option<Vec<T>>, Failure> {
    match values {
        [] => Ok(None),
        [one] => Ok(Some(vec![*one; joints])),
        several if several.len() == joints => Ok(Some(several.to_vec())),
        several => Err(Failure::input(
            format!(
                "{flag} has {} values, the robot has {joints} joints",
                several.len()
            ),
            format!("Give {flag} one value for all joints, or {joints}."),
        )),
    }
}

fn read(path: &Path, robot: &Robot) -> Result<File, Failure> {
    let place = path.display();
    let text = std::fs::read_to_string(path)
        .map_err(|e| Failure::input(format!("{place}: cannot be read ({e})"), ""))?;
    let file: File = toml::from_str(&text).map_err(|e| {
        let line = e.span().map_or(String::new(), |s| {
            format!(
                ", line {}",
                text[..s.start.min(text.len())].lines().count().max(1)
            )
        });
        Failure::input(
            format!("{place}{line}: {}", e.message()),
            "docs/excitation.md shows a file of limits.",
        )
    })?;
    let names = robot.joint_names();
    if let Some(stranger) = file.joints.keys().find(|name| !names.contains(name)) {
        return Err(Failure::input(
            format!("{place}: the robot has no joint {stranger:?}"),
            format!("Its joints are {}.", names.join(", ")),
        ));
    }
    for limits in file.joints.values().chain([&file.all]) {
        let sizes = [limits.velocity, limits.acceleration, limits.jerk];
        let usable = |v: &f64| v.is_finite() && *v > 0.0;
        if !sizes.iter().flatten().all(usable) {
            return Err(Failure::input(
                format!("{place}: velocity, acceleration and jerk must be above zero"),
                "",
            ));
        }
    }
    let regions = file.tool.boxes.iter().all(|b| {
        let sides = b.lower.iter().zip(&b.upper);
        sides
            .clone()
            .all(|(l, u)| l < u && l.is_finite() && u.is_finite())
    }) && file
        .tool
        .spheres
        .iter()
        .all(|s| s.radius > 0.0 && s.radius.is_finite());
    if !regions {
        return Err(Failure::input(
            format!("{place}: a box needs `lower` below `upper`, a sphere a radius above zero"),
            "",
        ));
    }
    Ok(file)
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    fn with(more: &[&str], file: Option<&str>) -> Result<Given, Failure> {
        let robot = Robot::builtin("ur5").unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("limits.toml");
        let mut line = vec!["excite"];
        line.extend(more);
        let name = path.display().to_string();
        if let Some(text) = file {
            std::fs::write(&path, text).unwrap();
            line.extend(["--limits", &name]);
        }
        given(&robot, &Arguments::try_parse_from(line).unwrap())
    }

    #[test]
    fn flags_go_before_the_file_and_the_file_before_the_description() {
        let file = "[all]\nacceleration = 3\n[joints.elbow_joint]\nlower = -1\nupper = 2\nvelocity = 0.5\n\
                    [tool]\npoint = [0, 0, 0.1]\nspheres = [{ centre = [0, 0, 0.5], radius = 0.9 }]\n";
        let g = with(&["--velocity", "1.5"], Some(file)).unwrap();
        let elbow = g.limits[2];
        assert_eq!((elbow.lower, elbow.upper, elbow.velocity), (-1.0, 2.0, 1.5));
        assert!(
            g.limits
                .iter()
                .all(|l| l.acceleration == 3.0 && (l.jerk - 30.0).abs() < 1e-12)
        );
        assert_eq!((g.assumed, g.tool), ([false, true], [0.0, 0.0, 0.1]));
        assert_eq!(g.regions.len(), 1);
        let plain = with(&[], None).unwrap();
        assert_eq!(plain.limits[0].velocity, std::f64::consts::PI);
        assert_eq!(plain.assumed, [true, true]);
    }

    #[test]
    fn what_does_not_fit_is_refused() {
        let refused = |more: &[&str], file: Option<&str>| with(more, file).err().unwrap();
        let wrong = refused(&["--velocity", "1,2,3"], None);
        assert!(wrong.message.contains("3 values") && wrong.status == 2);
        for (file, fragment) in [
            ("[joints.elbow]\nvelocity = 1\n", "no joint"),
            ("[all]\nspeed = 1\n", "unknown field `speed`"),
            ("[all]\nvelocity = -1\n", "above zero"),
            (
                "[tool]\nboxes = [{ lower = [0,0,0], upper = [1,1,0] }]\n",
                "box",
            ),
        ] {
            let wrong = refused(&[], Some(file));
            assert!(wrong.message.contains(fragment), "{}", wrong.message);
            assert_eq!(wrong.status, 2);
        }
    }
}
