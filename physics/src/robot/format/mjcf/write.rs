//! What changes in an MJCF when its robot does.

use super::attributes::ORIENTATIONS;
use super::chain::Chain;
use super::couplings;
use super::edit::Changes;
use super::pose::inverse;
use super::scene::{Kind, Scene};
use super::settings::FromGeoms;
use super::shapes;
use super::source::Element;
use crate::robot::{Inertia, Robot, RobotError};
use nalgebra::{Rotation3, UnitQuaternion};

/// Change of a link's parameters, relative to their size, that is rounding.
const ROUNDING: f64 = 1e-12;

/// How often bodies are made lighter.
const HALVES: i32 = 30;

/// A body whose second moments are this far below zero, relative, is still a possible one.
const POSSIBLE: f64 = 1e-9;

/// Changes that make the robot of `scene` into `robot`, with its zeros moved.
pub(super) fn changes(
    scene: &Scene<'_, '_, '_>,
    chain: &Chain,
    robot: &Robot,
    zeros: &[f64],
) -> Result<Changes, RobotError> {
    let given = chain.robot(scene)?;
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
        let zero = zeros.get(link).copied().unwrap_or(0.0);
        if zero != 0.0 {
            // `ref` is the position that the joint has where the model is drawn.
            let unit = if own.kind == Kind::Slide {
                1.0
            } else {
                scene.settings.angle
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
    if robot.gravity() != given.gravity() {
        gravity(scene, &mut changes, robot);
    }
    Ok(changes)
}

fn departs(old: &Inertia, new: &Inertia) -> bool {
    let (old, new) = (old.parameters(), new.parameters());
    let size = |part: std::ops::Range<usize>| -> f64 {
        let largest = old[part.clone()].iter().chain(&new[part]);
        largest.fold(0.0, |m: f64, v| m.max(v.abs()))
    };
    let apart = |part: std::ops::Range<usize>| {
        let allowed = ROUNDING * size(part.clone());
        part.into_iter().any(|k| (old[k] - new[k]).abs() > allowed)
    };
    apart(0..1) || apart(1..4) || apart(4..10)
}

/// Bodies of a link with the inertias, in their own frames, that together make the link's: the body that the joint moves has
/// what the others do not. Where that is no possible body the others are made lighter, by halves, until it is; MuJoCo wants
/// mass in whatever moves, as fingers do.
fn inertias(chain: &Chain, link: usize, whole: &Inertia) -> Vec<(usize, Inertia)> {
    let mut own = chain.bodies(link);
    let Some(first) = own.next() else {
        return Vec::new();
    };
    let others: Vec<usize> = own.filter(|&b| chain.inertias[b].mass > 0.0).collect();
    let scaled = |body: usize, factor: f64| {
        Inertia::from_parameters(&chain.inertias[body].parameters().map(|v| v * factor))
    };
    let rest = |part: f64| {
        let parts = others.iter().map(|&b| scaled(b, -part));
        parts.fold(*whole, |sum, part| sum.plus(&part))
    };
    let mut parts = (0..HALVES).map(|k| 0.5_f64.powi(k));
    let part = parts.find(|&s| rest(s).is_consistent(POSSIBLE));
    let part = part.unwrap_or(0.5_f64.powi(HALVES));
    let placed = |body: usize, inertia: Inertia| {
        let (to_body, origin) = inverse(&chain.poses[body]);
        (body, inertia.transformed(&to_body, &origin))
    };
    let lighter = others.iter().filter(|_| part < 1.0);
    std::iter::once(placed(first, rest(part)))
        .chain(lighter.map(|&b| placed(b, scaled(b, part))))
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
                heavy |= shapes::counts(geom, &scene.settings)?;
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
        let (moments, quat) = principal(inertia);
        let values = [
            ("pos", words(inertia.com().as_slice())),
            ("mass", inertia.mass.to_string()),
            ("diaginertia", words(&moments)),
            ("quat", words(&quat)),
        ];
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
