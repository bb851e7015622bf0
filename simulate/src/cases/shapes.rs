//! Random shapes of the effects.

use super::outside::outside;
use super::scene::{Scene, Shape};
use super::withheld::Withheld;
use crate::families::log_uniform;
use crate::mechanism::{CouplingKind, DragKind, Grab, Pins, Runout, StribeckKind};
use crate::reference::Session;
use nalgebra::Vector3;
use rand::RngExt;
use rand::seq::IndexedRandom;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};
use std::f64::consts::TAU;

/// A shape of the effect with this name, or none if this arm has no joint for it.
pub fn shape(name: &str, scene: &Scene, rng: &mut ChaCha8Rng) -> Option<Shape> {
    let n = scene.arm.dof();
    let rehearsal = scene.rehearsal;
    let loaded: Vec<usize> = (0..n)
        .filter(|&j| rehearsal.gravity[j] > 0.3 * rehearsal.torque[j])
        .collect();
    let any = rng.random_range(0..n);
    let heavy = loaded.choose(rng).copied();
    let geared: Vec<usize> = (0..n).filter(|&j| scene.arm.disc[j] > 0.0).collect();
    let geared = geared.choose(rng).copied();
    let sign = if rng.random_bool(0.5) { 1.0 } else { -1.0 };
    let speed = |j: usize| rehearsal.velocity[j];
    let angular = |j: usize| scene.arm.joints[j].kind.is_rotation();
    // Lengths of angle: a sliding joint's positions are smaller than a turning one's.
    let reach = |j: usize| scene.arm.reach[j] / 1.4;
    let on = |j: usize, effect: Withheld, low: f64, high: f64, rng: &mut ChaCha8Rng| {
        Some(Shape {
            effect,
            joint: Some(j),
            share: log_uniform(rng, low, high),
        })
    };
    let anywhere = |effect: Withheld, low: f64, high: f64, rng: &mut ChaCha8Rng| {
        Some(Shape {
            effect,
            joint: None,
            share: log_uniform(rng, low, high),
        })
    };
    match name {
        "link_parameters" => {
            let link = rng.random_range(n.min(2) - 1..n);
            let size = scene.arm.joints[link].link.inertia.com().norm().max(0.05);
            let shift = unit(rng) * (size * rng.random_range(0.1..0.4));
            let effect = Withheld::Link {
                link,
                mass: sign,
                shift,
                inertia: rng.random_range(-0.6..0.6),
            };
            anywhere(effect, 0.06, 0.25, rng)
        }
        "friction_parameters" => {
            let other = rng.random_range(0..n);
            let mut joints = vec![(any, sign, sign * rng.random_range(0.2..1.0))];
            if other != any && rng.random_bool(0.4) {
                joints.push((other, -sign * rng.random_range(0.3..1.0), sign));
            }
            on(any, Withheld::Friction { joints }, 0.06, 0.25, rng)
        }
        "payload" => {
            let scale = scene.arm.joints[n - 1].link.inertia.com().norm().max(0.05);
            let com = Vector3::new(1.0, 1.0, 0.0).component_mul(&unit(rng)) * scale
                + scene.arm.joints[n - 1].link.inertia.com() * rng.random_range(0.8..1.6);
            let gyration = 0.4 * scale;
            anywhere(Withheld::Payload { com, gyration }, 0.04, 0.2, rng)
        }
        "rotor_inertia" => on(any, Withheld::Rotor { joint: any }, 0.06, 0.3, rng),
        "base_tilt" => {
            let direction = rng.random_range(0.0..TAU);
            anywhere(Withheld::Tilt { direction }, 0.04, 0.15, rng)
        }
        "counterbalance" => {
            let j = heavy.filter(|&j| angular(j))?;
            let base = rng.random_range(0.3..0.7);
            let pins = Pins {
                lever: base * rng.random_range(0.25..0.7),
                base,
                angle: rng.random_range(0.4..2.7) * sign - scene.arm.centre[j],
            };
            let effect = if rng.random_bool(0.5) {
                let volume = base * rng.random_range(0.8..2.0);
                Withheld::Gas {
                    joint: j,
                    pins,
                    volume,
                }
            } else {
                let free = rng.random_range(0.5..1.0);
                Withheld::Coil {
                    joint: j,
                    pins,
                    free,
                }
            };
            on(j, effect, 0.1, 0.5, rng)
        }
        "asymmetric_friction" => {
            let (coulomb, viscous) = if rng.random_bool(0.35) {
                (sign, 0.0)
            } else {
                (0.2 * sign * rng.random_range(-1.0..1.0), sign / speed(any))
            };
            let joint = any;
            on(
                any,
                Withheld::Asymmetric {
                    joint,
                    coulomb,
                    viscous,
                },
                0.05,
                0.2,
                rng,
            )
        }
        "stribeck_friction" => {
            let law = match rng.random_range(0..3) {
                0 => StribeckKind::Lorentz,
                1 => StribeckKind::HalfCosine,
                _ => StribeckKind::Film(rng.random_range(0.01..0.04)),
            };
            let v_s = speed(any) * rng.random_range(0.12..0.5);
            on(
                any,
                Withheld::Stribeck {
                    joint: any,
                    v_s,
                    law,
                },
                0.06,
                0.25,
                rng,
            )
        }
        "nonlinear_viscous_friction" => {
            let law = *[DragKind::Eyring, DragKind::Churning, DragKind::Carreau].choose(rng)?;
            let v_0 = speed(any) * rng.random_range(0.08..0.5);
            let v_top = 2.5 * speed(any);
            let effect = Withheld::Drag {
                joint: any,
                v_0,
                v_top,
                law,
            };
            on(any, effect, 0.06, 0.25, rng)
        }
        "load_dependent_friction" => {
            let j = heavy.unwrap_or(any);
            on(j, Withheld::Mesh { joint: j }, 0.05, 0.2, rng)
        }
        "position_dependent_friction" => {
            // A part turns at least once over the range, with the joint or a stage of its gear.
            let once = (0.5 * TAU / scene.arm.reach[any]).ceil();
            let order = if rng.random_bool(0.5) && angular(any) {
                once + f64::from(rng.random_range(0..4))
            } else {
                once * rng.random_range(1.0..9.0)
            };
            let law = if rng.random_bool(0.5) {
                Runout::BentShaft(rng.random_range(0.4..0.95))
            } else {
                Runout::Eccentric
            };
            let effect = Withheld::Runout {
                joint: any,
                order,
                phase: rng.random_range(0.0..TAU),
                viscous: rng.random_range(0.0..0.5) / speed(any),
                law,
            };
            on(any, effect, 0.05, 0.2, rng)
        }
        "presliding_hysteresis" => {
            let effect = Withheld::Bristle {
                joint: any,
                elastic: rng.random_range(0.05..0.5),
                more: rng.random_range(0.0..0.15),
                damping: 0.3 * scene.inertia[any] * TAU * 15.0,
            };
            on(any, effect, 0.05, 0.14, rng)
        }
        "friction_drift" => {
            let effect = Withheld::Warm {
                joint: any,
                fading: rng.random_range(1.2..3.0),
                time: rng.random_range(50.0..160.0),
                coulomb: if rng.random_bool(0.5) { 1.0 } else { 0.0 },
                power: rehearsal.power[any],
            };
            on(any, effect, 0.05, 0.2, rng)
        }
        "torque_ripple" => {
            let first = rng.random_range(5.0..28.0) / reach(any);
            let mut waves = vec![[first, 1.0, rng.random_range(0.0..TAU)]];
            for _ in 0..rng.random_range(1..3) {
                let order = first * rng.random_range(1.3..3.7);
                waves.push([
                    order,
                    rng.random_range(0.2..0.7),
                    rng.random_range(0.0..TAU),
                ]);
            }
            on(any, Withheld::Ripple { joint: any, waves }, 0.05, 0.25, rng)
        }
        "joint_elasticity" => {
            let j = geared?;
            let effect = Withheld::Elastic {
                joint: j,
                hardening: rng.random_range(0.05..0.2),
                ratio: rng.random_range(0.02..0.08),
            };
            on(j, effect, 0.05, 0.16, rng)
        }
        "backlash" => {
            let j = geared?;
            let stiffness = scene.inertia[j] * (TAU * rng.random_range(25.0..40.0)).powi(2);
            on(
                j,
                Withheld::Play {
                    joint: j,
                    stiffness,
                },
                0.05,
                0.15,
                rng,
            )
        }
        "joint_coupling" => {
            let driver = (0..n)
                .filter(|&j| j != any && angular(j) == angular(any))
                .collect::<Vec<_>>();
            let driver = *driver.choose(rng)?;
            let law = match rng.random_range(0..5) {
                0 | 1 => CouplingKind::Viscous,
                2 | 3 => CouplingKind::Seal(rng.random_range(-0.3..0.3)),
                _ => CouplingKind::Wheel,
            };
            let effect = Withheld::Coupling {
                driver,
                driven: any,
                law,
            };
            on(any, effect, 0.06, 0.25, rng)
        }
        "torque_gain" => on(any, Withheld::Gain { joint: any, sign }, 0.05, 0.25, rng),
        "torque_offset" => on(any, Withheld::Offset { joint: any, sign }, 0.04, 0.2, rng),
        "time_delay" => {
            let sign = if rng.random_bool(0.75) { 1.0 } else { -1.0 };
            anywhere(Withheld::Delay { sign }, 0.04, 0.15, rng)
        }
        "saturation" => {
            let greatest = rehearsal.greatest[any];
            on(
                any,
                Withheld::Saturation {
                    joint: any,
                    greatest,
                },
                0.05,
                0.15,
                rng,
            )
        }
        "encoder_offset" => on(any, Withheld::Zero { joint: any, sign }, 0.04, 0.2, rng),
        "external_contact" => {
            let com = scene.arm.joints[n - 1].link.inertia.com();
            let effect = Withheld::Contact {
                point: com + unit(rng) * 0.05,
                grabs: grabs(scene.session, rng),
            };
            anywhere(effect, 0.1, 0.35, rng)
        }
        "outside" => outside(scene, any, rng),
        _ => None,
    }
}

/// Touches in about half of the trajectories, in train and test alike.
fn grabs(session: &Session, rng: &mut ChaCha8Rng) -> Vec<Grab> {
    let mut grabs = Vec::new();
    for (i, (start, length)) in session.starts.iter().zip(&session.lengths).enumerate() {
        // The third and every other test trajectory, and the first, are always touched.
        if i != 0 && i % 6 != 2 && rng.random_bool(0.55) {
            continue;
        }
        let mut t = start + rng.random_range(0.5..5.0);
        for _ in 0..rng.random_range(1..3) {
            let end = t + rng.random_range(0.8..3.0);
            if end > start + length - 0.3 {
                break;
            }
            grabs.push(Grab {
                start: t,
                end,
                stiffness: log_uniform(rng, 200.0, 900.0),
                damping: 8.0,
                limit: rng.random_range(20.0..60.0),
            });
            t = end + rng.random_range(1.0..4.0);
        }
    }
    grabs
}

fn unit(rng: &mut ChaCha8Rng) -> Vector3<f64> {
    let v = Vector3::from_fn(|_, _| StandardNormal.sample(rng));
    v.try_normalize(1e-6).unwrap_or(Vector3::x())
}
