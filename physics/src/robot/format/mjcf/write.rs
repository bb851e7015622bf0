//! Changes in an MJCF when its robot changes.

use super::attributes::ORIENTATIONS;
use super::chain::Chain;
use super::couplings;
use super::edit::Changes;
use super::pose::inverse;
use super::scene::{Kind, Scene};
use super::settings::FromGeoms;
use super::shapes;
use super::source::Element;
use crate::robot::format::changed::{Changed, load_name};
use crate::robot::format::share::{departs, share};
use crate::robot::{Inertia, Robot, RobotError};
use nalgebra::{Rotation3, UnitQuaternion};

/// Changes that make the robot of `scene` into a changed one. A tilt of the base has no place here but gravity's.
pub(super) fn changes(
    scene: &Scene<'_, '_, '_>,
    chain: &Chain,
    changed: &Changed<'_>,
) -> Result<Changes, RobotError> {
    let (given, robot) = (chain.robot(scene)?, changed.robot);
    if given.joint_names() != robot.joint_names() {
        let known = given.joint_names();
        let other = robot.joint_names().into_iter().find(|n| !known.contains(n));
        return Err(RobotError::Mismatch {
            what: "joint",
            name: other.unwrap_or_else(|| robot.name().to_owned()),
        });
    }
    let mut changes = Changes::default();
    let mut bodies = Vec::new();
    for (link, (old, new)) in given.joints().iter().zip(robot.joints()).enumerate() {
        let own = &scene.joints[chain.joints[link]];
        let element = own.attributes.element;
        let [damping, armature] = couplings::reflected(scene, chain.joints[link])?;
        for (name, old, new, reflected) in [
            ("damping", old.damping, new.damping, damping),
            ("frictionloss", old.friction, new.friction, 0.0),
            ("armature", old.rotor_inertia, new.rotor_inertia, armature),
        ] {
            if old == new {
                continue;
            }
            let acts = match name {
                "damping" => scene.settings.dampers,
                "frictionloss" => scene.settings.friction,
                _ => true,
            };
            if !acts {
                changes.left_out.push(format!(
                    "{name} of joint {}: a <flag> of the model switches it off",
                    own.name
                ));
            }
            if new < reflected {
                changes.left_out.push(format!(
                    "{name} of joint {}: its actuator alone adds {reflected}, more than the {new} it should have",
                    own.name
                ));
            }
            changes.set(element, name, &(new - reflected).max(0.0).to_string());
        }
        let zero = changed.zero(link);
        if zero != 0.0 {
            // `ref` is the position that the joint has where the model is drawn.
            let unit = if own.kind == Kind::Slide {
                1.0
            } else {
                own.angle
            };
            let drawn = own.attributes.number("ref")?.unwrap_or(0.0);
            changes.set(element, "ref", &(drawn - zero / unit).to_string());
            // A spring rests where it did: its reference is a position of the joint, too.
            let stiffness = own.attributes.list("stiffness")?.unwrap_or_default();
            if stiffness.iter().any(|k| *k != 0.0) {
                let rest = own.attributes.number("springref")?.unwrap_or(0.0);
                changes.set(element, "springref", &(rest - zero / unit).to_string());
            }
        }
        if departs(&old.link.inertia, &new.link.inertia) {
            bodies.extend(inertias(chain, link, &new.link.inertia));
        }
    }
    write_bodies(scene, &mut changes, &bodies)?;
    if let Some(load) = &changed.load {
        let own = &scene.joints[chain.joints[load.link]];
        if let Some(element) = scene.bodies[own.body].element {
            // The link's frame lies where its joint is, the body's where its own origin is.
            let (to_body, origin) = inverse(&chain.poses[own.body]);
            let inertia = load.inertia.transformed(&to_body, &origin);
            let taken = |name: &str| scene.bodies.iter().any(|b| b.name == name);
            let body = format!(
                "<body name=\"{}\"><inertial {}/></body>",
                load_name(taken),
                attributes(&inertia)
                    .map(|(name, value)| format!("{name}=\"{value}\""))
                    .join(" ")
            );
            changes.add_last(element, &body);
        }
    }
    if robot.gravity() != given.gravity() {
        gravity(scene, &mut changes, robot);
    }
    Ok(changes)
}

/// Bodies of a link with the inertias, in their own frames, that together make the link's.
fn inertias(chain: &Chain, link: usize, whole: &Inertia) -> Vec<(usize, Inertia)> {
    let own: Vec<usize> = chain.bodies(link).collect();
    let heavy = own.iter().filter(|&&b| chain.inertias[b].mass > 0.0);
    let mut bodies: Vec<usize> = heavy.copied().collect();
    if bodies.is_empty() {
        bodies.extend(own.first());
    }
    let list: Vec<Inertia> = bodies.iter().map(|&b| chain.inertias[b]).collect();
    let shared = bodies.iter().zip(share(whole, &list));
    shared
        .map(|(&body, inertia)| {
            let (to_body, origin) = inverse(&chain.poses[body]);
            (body, inertia.transformed(&to_body, &origin))
        })
        .collect()
}

/// Writes `<inertial>` elements.
fn write_bodies(
    scene: &Scene<'_, '_, '_>,
    changes: &mut Changes,
    bodies: &[(usize, Inertia)],
) -> Result<(), RobotError> {
    if bodies.is_empty() {
        return Ok(());
    }
    if scene.settings.from_geoms == FromGeoms::Always {
        let written = |b: usize| bodies.iter().any(|(own, _)| *own == b);
        for (b, body) in scene.bodies.iter().enumerate() {
            let mut heavy = false;
            for geom in &body.geoms {
                heavy |= shapes::counts(geom, scene.settings_of(b))?;
            }
            if body.inertial.is_some() && heavy && !written(b) {
                changes.left_out.push(format!(
                    "inertias: compiler inertiafromgeom=\"true\" makes MuJoCo ignore every <inertial>, and with \"auto\" that of \
                     body {} would count too",
                    body.name
                ));
                return Ok(());
            }
        }
        for compiler in scene.root.tagged("compiler") {
            if compiler.get("inertiafromgeom").is_some() {
                changes.set(compiler, "inertiafromgeom", "auto");
            }
        }
    }
    for (b, inertia) in bodies {
        let body = &scene.bodies[*b];
        let Some(element) = body.element else {
            continue;
        };
        let values = attributes(inertia);
        match &body.inertial {
            Some(old) => rewrite(changes, old.element, &values),
            None => {
                let attributes = values.map(|(name, value)| format!("{name}=\"{value}\""));
                let new = format!("<inertial {}/>", attributes.join(" "));
                changes.add_first(element, &new);
            }
        }
    }
    Ok(())
}

/// Attributes of an `<inertial>`.
fn attributes(inertia: &Inertia) -> [(&'static str, String); 4] {
    let (moments, quat) = principal(inertia);
    [
        ("pos", words(inertia.com().as_slice())),
        ("mass", inertia.mass.to_string()),
        ("diaginertia", words(&moments)),
        ("quat", words(&quat)),
    ]
}

/// Principal moments about the centre of mass and the directions of their axes (w, x, y, z). MuJoCo refuses a moment above the
/// sum of the other two, be it by rounding: these are raised to it.
fn principal(inertia: &Inertia) -> ([f64; 3], [f64; 4]) {
    let mut axes = inertia.about_com().symmetric_eigen();
    if axes.eigenvectors.determinant() < 0.0 {
        axes.eigenvectors.column_mut(2).neg_mut();
    }
    let mut moments = axes.eigenvalues.map(|v| v.max(0.0));
    let (largest, most) = moments.argmax();
    let over = 2.0 * most - moments.sum();
    if over > 0.0 {
        let others = moments.iter_mut().enumerate();
        for (_, moment) in others.filter(|(k, _)| *k != largest) {
            *moment += over / 2.0 + f64::EPSILON * most;
        }
    }
    let rotation = Rotation3::from_matrix_unchecked(axes.eigenvectors);
    let q = UnitQuaternion::from_rotation_matrix(&rotation);
    (moments.into(), [q.w, q.i, q.j, q.k])
}

fn rewrite(changes: &mut Changes, inertial: Element<'_, '_>, values: &[(&str, String); 4]) {
    // What stands for the same under another name gives it up.
    let other = |name: &str| match name {
        "diaginertia" => inertial.get("fullinertia").map(|_| "fullinertia"),
        "quat" => ORIENTATIONS
            .into_iter()
            .find(|name| inertial.get(name).is_some()),
        _ => None,
    };
    for (name, value) in values {
        match other(name) {
            Some(old) if inertial.get(name).is_none() => {
                changes.replace(inertial, old, name, value);
            }
            old => {
                changes.set(inertial, name, value);
                old.into_iter()
                    .for_each(|old| changes.remove(inertial, old));
            }
        }
    }
}

/// Writes gravity to the `<option>` that decides it.
fn gravity(scene: &Scene<'_, '_, '_>, changes: &mut Changes, robot: &Robot) {
    if scene.settings.weightless {
        let text = "gravity: a <flag> of the model switches it off".to_owned();
        changes.left_out.push(text);
    }
    let value = words(robot.gravity().as_slice());
    let options = scene.root.tagged("option");
    let deciding = options.iter().rev().find(|o| o.get("gravity").is_some());
    match deciding.or(options.last()) {
        Some(option) => changes.set(*option, "gravity", &value),
        None => changes.add_first(scene.root, &format!("<option gravity=\"{value}\"/>")),
    }
}

pub(super) fn words(values: &[f64]) -> String {
    let words: Vec<String> = values.iter().map(f64::to_string).collect();
    words.join(" ")
}
