//! The doubts that follow from a chain's numbers.

use super::{AIR, Body, Doubt, Finding, HEAVIEST};
use crate::robot::{Inertia, Joint, JointKind, Limits};
use nalgebra::{Matrix3, Rotation3, Unit, Vector3};

/// Ratio of a link's mass to that of the link that carries it, below which the mass is doubtful. Motor,
/// bearings and housing of neighbours are of like size; of the built-in arms the lightest is a twelfth of its
/// neighbour.
const LIGHT: f64 = 0.01;

/// Relative difference below which two numbers count as written alike.
const ALIKE: f64 = 1e-9;

/// A slow joint's speed where a description limits none, rad/s or m/s.
const SLOW: f64 = 1.0;

/// Poses at which a description's weight is compared with its drives.
const POSES: usize = 128;

/// Doubts about a chain's numbers. `bodies` are its bodies as they are written, `gravity` is in m/s².
pub(crate) fn judge(joints: &[Joint], bodies: &[Body], gravity: &Vector3<f64>) -> Vec<Finding> {
    let mut findings = Vec::new();
    let heavy: Vec<&Body> = bodies.iter().filter(|b| b.inertia.mass > 0.0).collect();
    let alike = placeholders(joints, &heavy);
    if let Some(first) = alike.first() {
        let doubt = Doubt::Placeholders(first.inertia.mass);
        findings.push(Finding::of_bodies(doubt, &alike));
    }
    if alike.is_empty() && has_equal_masses(&heavy) {
        let doubt = Doubt::EqualMasses(heavy[0].inertia.mass);
        findings.push(Finding::of_bodies(doubt, &heavy));
    }
    let told = |name: &str| alike.iter().any(|b| b.name == name);
    for body in heavy.iter().filter(|b| !told(&b.name)) {
        if let Some(density) = density(&body.inertia)
            && !(AIR..=HEAVIEST).contains(&density)
        {
            findings.push(Finding::of_bodies(Doubt::NoMaterial(density), &[*body]));
        }
    }
    for pair in joints.windows(2) {
        let (before, own) = (pair[0].link.inertia.mass, &pair[1].link);
        if own.inertia.mass < LIGHT * before && !told(&own.name) {
            let doubt = Doubt::Light(own.inertia.mass, before);
            findings.push(Finding::of_link(doubt, &pair[1]));
        }
    }
    for (joint, distance, longest) in far_away(joints) {
        findings.push(Finding::of_link(Doubt::FarAway(distance, longest), joint));
    }
    for (joint, weight) in joints.iter().zip(weights(joints, gravity)) {
        let Limits {
            effort, velocity, ..
        } = joint.limits;
        if weight > effort {
            let doubt = Doubt::BeyondDrive(weight, effort);
            findings.push(Finding::of_joint(doubt, &joint.name));
        }
        let speed = if velocity.is_finite() { velocity } else { SLOW };
        if joint.damping * speed > effort {
            let numbers = [joint.damping * speed, speed, effort];
            findings.push(Finding::of_joint(Doubt::ServoDamping(numbers), &joint.name));
        }
    }
    if let Some((damping, friction)) = equal_friction(joints) {
        let names: Vec<String> = joints.iter().map(|j| j.name.clone()).collect();
        findings.push(Finding {
            doubt: Doubt::EqualFriction(damping, friction),
            joints: names.clone(),
            names,
        });
    }
    findings
}

/// Bodies with one mass and one inertia although they differ in shape: more than half of all, and all of them or at least
/// three, as an arm may hold a part twice. A single body is like no other, whatever its numbers.
fn placeholders<'a>(joints: &[Joint], bodies: &[&'a Body]) -> Vec<&'a Body> {
    let unit = |b: &&Body| {
        let i = &b.inertia;
        i.mass == 1.0 && (i.about_com() - Matrix3::identity()).amax() < ALIKE
    };
    if bodies.len() >= 2 && bodies.iter().all(unit) {
        return bodies.to_vec();
    }
    let moments = |b: &Body| b.inertia.principal_moments();
    let near = |a: f64, b: f64| (a - b).abs() <= 1e3 * ALIKE * a.abs().max(b.abs());
    let same = |a: &Body, b: &Body| {
        a.inertia.mass == b.inertia.mass
            && moments(a).iter().zip(moments(b)).all(|(&a, b)| near(a, b))
    };
    let groups = bodies.iter().map(|first| {
        let own = bodies.iter().filter(|b| same(first, b)).copied();
        own.collect::<Vec<&Body>>()
    });
    let Some(group) = groups.max_by_key(Vec::len) else {
        return Vec::new();
    };
    let most = 2 * group.len() > bodies.len() && group.len() >= 2;
    let several = group.len() == bodies.len() || group.len() >= 3;
    // What one part is of has one centre of mass and one length.
    let centre = |b: &&Body| b.inertia.com().norm();
    let centres: Vec<f64> = group.iter().map(centre).collect();
    let lengths: Vec<f64> = joints
        .windows(2)
        .filter(|pair| group.iter().any(|b| b.name == pair[0].link.name))
        .map(|pair| pair[1].translation.norm())
        .collect();
    let differ = |values: &[f64]| values.iter().any(|v| (v - values[0]).abs() > 1e-6);
    let at_joint = centres.iter().all(|&c| c == 0.0);
    if most && several && (differ(&centres) || differ(&lengths) || at_joint) {
        group
    } else {
        Vec::new()
    }
}

/// Whether three bodies or more that are not alike all weigh the same. Two links of one mass are in every textbook.
fn has_equal_masses(bodies: &[&Body]) -> bool {
    let Some(first) = bodies.first().filter(|_| bodies.len() > 2) else {
        return false;
    };
    let apart = |a: f64, b: f64| (a - b).abs() > 1e3 * ALIKE * a.abs().max(b.abs());
    let unlike = |b: &&Body| {
        let moments = b.inertia.principal_moments();
        let mut pairs = moments.into_iter().zip(first.inertia.principal_moments());
        pairs.any(|(a, b)| apart(a, b)) || apart(b.inertia.com().norm(), first.inertia.com().norm())
    };
    bodies.iter().all(|b| b.inertia.mass == first.inertia.mass) && bodies.iter().any(unlike)
}

/// Density of the ellipsoid that has a body's mass and second moments, kg/m³; none for a point, a line or a plane, or where
/// no body has the inertia.
fn density(inertia: &Inertia) -> Option<f64> {
    let about = inertia.about_com();
    let second = Matrix3::identity() * (0.5 * about.trace()) - about;
    let moments = second.symmetric_eigenvalues() / inertia.mass;
    // A flat or thin body is described by formulas that leave its thickness out.
    if moments.min() <= 1e-3 * moments.max() {
        return None;
    }
    // A semi-axis a has the second moment a²/5 per mass.
    let axes = moments.map(|m| (5.0 * m).sqrt());
    Some(inertia.mass / (4.0 / 3.0 * std::f64::consts::PI * axes.product()))
}

/// Links all of whose mass lies farther from their joints than the arm's longest link is long.
fn far_away(joints: &[Joint]) -> Vec<(&Joint, f64, f64)> {
    let length = |j: &Joint| {
        let stroke = match j.kind {
            JointKind::Prismatic => j.limits.lower.abs().max(j.limits.upper.abs()),
            _ => 0.0,
        };
        j.translation.norm() + Some(stroke).filter(|s| s.is_finite()).unwrap_or(0.0)
    };
    let longest = joints.iter().skip(1).map(length).fold(0.0, f64::max);
    let mut found = Vec::new();
    for (k, joint) in joints.iter().enumerate().filter(|_| longest > 0.0) {
        let inertia = &joint.link.inertia;
        let next = joints
            .get(k + 1)
            .map_or(Vector3::zeros(), |j| j.translation);
        let com = inertia.com();
        let along = com.dot(&next) / next.norm_squared().max(f64::MIN_POSITIVE);
        let apart = (com - next * along.clamp(0.0, 1.0)).norm();
        let spread = 0.5 * inertia.about_com().trace() / inertia.mass.max(f64::MIN_POSITIVE);
        let nearest = apart - (5.0 * spread.max(0.0)).sqrt();
        if nearest > longest {
            found.push((joint, nearest, longest));
        }
    }
    found
}

/// The largest torque or force by which the described weight loads each joint, over poses within the limits.
fn weights(joints: &[Joint], gravity: &Vector3<f64>) -> Vec<f64> {
    let mut most = vec![0.0_f64; joints.len()];
    for pose in 0..POSES {
        let (mut rotation, mut origin) = (Matrix3::identity(), Vector3::zeros());
        let mut frames = Vec::new();
        for (k, joint) in joints.iter().enumerate() {
            let q = position(&joint.limits, joint.kind, pose, k);
            origin += rotation * joint.translation;
            rotation *= joint.rotation;
            if joint.kind.is_rotation() {
                let axis = Unit::new_unchecked(joint.axis);
                rotation *= Rotation3::from_axis_angle(&axis, q).into_inner();
            } else {
                origin += rotation * joint.axis * q;
            }
            frames.push((rotation, origin));
        }
        // Mass and first moment of what each joint carries, in the base frame.
        let (mut mass, mut moment) = (0.0, Vector3::zeros());
        for (k, joint) in joints.iter().enumerate().rev() {
            let (rotation, origin) = &frames[k];
            let own = &joint.link.inertia;
            mass += own.mass;
            moment += rotation * own.first_moment + origin * own.mass;
            let axis = rotation * joint.axis;
            let load = if joint.kind.is_rotation() {
                axis.dot(&(moment - origin * mass).cross(gravity))
            } else {
                axis.dot(gravity) * mass
            };
            most[k] = most[k].max(load.abs());
        }
    }
    most
}

/// Position of a joint in one of the poses: Weyl's sequence by the root of a prime of its own (Niederreiter, "Random number
/// generation and quasi-Monte Carlo methods", 1992).
fn position(limits: &Limits, kind: JointKind, pose: usize, joint: usize) -> f64 {
    const PRIMES: [f64; 8] = [2.0, 3.0, 5.0, 7.0, 11.0, 13.0, 17.0, 19.0];
    let step = PRIMES[joint % PRIMES.len()].sqrt();
    let part = ((pose + 1) as f64 * step).fract();
    let full = match kind {
        JointKind::Prismatic => 0.0,
        _ => std::f64::consts::PI,
    };
    let within = |limit: f64, open: f64| if limit.is_finite() { limit } else { open };
    let (low, high) = (within(limits.lower, -full), within(limits.upper, full));
    low + part * (high - low)
}

/// Damping and friction that all joints share: of at least three joints, or of two if the numbers have one digit; otherwise none.
fn equal_friction(joints: &[Joint]) -> Option<(f64, f64)> {
    let first = joints.first().filter(|_| joints.len() > 1)?;
    let (damping, friction) = (first.damping, first.friction);
    let same = |j: &Joint| j.damping == damping && j.friction == friction;
    let round = |v: f64| {
        v == 0.0
            || format!("{v:e}")
                .split('e')
                .next()
                .is_some_and(|d| d.len() == 1)
    };
    let guess = joints.len() > 2 || (round(damping) && round(friction));
    let any = damping > 0.0 || friction > 0.0;
    (any && guess && joints.iter().all(same)).then_some((damping, friction))
}
