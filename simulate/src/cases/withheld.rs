//! Effects as they are withheld: the random shape of a mechanism, whose size is set afterwards.

use super::build::Build;
use crate::arm::altered;
use crate::mechanism::*;
use nalgebra::{Matrix3, Vector3};
use physics::robot::{Inertia, RobotError};

/// Shape of one withheld effect. The size that belongs to it has the unit that each variant states; joints count
/// from 0.
#[derive(Debug, Clone)]
pub enum Withheld {
    /// Size: relative error of mass; centre of mass and inertia err along.
    Link {
        link: usize,
        mass: f64,
        shift: Vector3<f64>,
        inertia: f64,
    },
    /// Size: relative error; joint, part in Coulomb and part in viscous friction.
    Friction { joints: Vec<(usize, f64, f64)> },
    /// Size: kg.
    Payload { com: Vector3<f64>, gyration: f64 },
    /// Size: kg·m².
    Rotor { joint: usize },
    /// Size: rad.
    Tilt { direction: f64 },
    /// Size: N at middle length.
    Gas {
        joint: usize,
        pins: Pins,
        volume: f64,
    },
    /// Size: N/m.
    Coil { joint: usize, pins: Pins, free: f64 },
    /// Size: N·m at top speed.
    Asymmetric {
        joint: usize,
        coulomb: f64,
        viscous: f64,
    },
    /// Size: N·m.
    Stribeck {
        joint: usize,
        v_s: f64,
        law: StribeckKind,
    },
    /// Size: N·m.
    Drag {
        joint: usize,
        v_0: f64,
        v_top: f64,
        law: DragKind,
    },
    /// Size: lost share.
    Mesh { joint: usize },
    /// Size: N·m at the tightest place.
    Runout {
        joint: usize,
        order: f64,
        phase: f64,
        viscous: f64,
        law: Runout,
    },
    /// Size: deflection when sliding, rad.
    Bristle {
        joint: usize,
        elastic: f64,
        more: f64,
        damping: f64,
    },
    /// Size: extra friction of the cold gear over the warm one.
    Warm {
        joint: usize,
        fading: f64,
        time: f64,
        coulomb: f64,
        power: f64,
    },
    /// Size: N·m of the first wave. Order, relative amplitude, phase.
    Ripple { joint: usize, waves: Vec<[f64; 3]> },
    /// Size: rad/N·m.
    Elastic {
        joint: usize,
        hardening: f64,
        ratio: f64,
    },
    /// Size: rad (half of the play).
    Play { joint: usize, stiffness: f64 },
    /// Size: that of the kind.
    Coupling {
        driver: usize,
        driven: usize,
        law: CouplingKind,
    },
    /// Size: gain − 1.
    Gain { joint: usize, sign: f64 },
    /// Size: N·m.
    Offset { joint: usize, sign: f64 },
    /// Size: s.
    Delay { sign: f64 },
    /// Size: part of the greatest torque (N·m, given) that is cut off.
    Saturation { joint: usize, greatest: f64 },
    /// Size: rad.
    Zero { joint: usize, sign: f64 },
    /// Size: scale of stiffness and force.
    Contact {
        point: Vector3<f64>,
        grabs: Vec<Grab>,
    },
    /// Size: N·m at 1 rad/s of both.
    CrossDrag { joints: [usize; 2], ratio: f64 },
    /// Size: N·m.
    CableTug {
        joints: [usize; 2],
        centre: [f64; 2],
        ratio: f64,
        slack: f64,
    },
    /// Size: rad/N·m.
    Mount {
        axis: Vector3<f64>,
        below: f64,
        mass: f64,
        ratio: f64,
    },
    /// Size: lost share.
    Dropouts {
        joint: usize,
        times: Vec<(f64, f64)>,
    },
    /// Size: N·m.
    Hum {
        joint: usize,
        frequency: f64,
        swell: f64,
    },
    /// Size: kg·m².
    Tank {
        joint: usize,
        frequency: f64,
        damping: f64,
    },
    /// Size: N·m.
    Wander {
        joint: usize,
        step: f64,
        knots: Vec<f64>,
    },
    /// Size: N·m.
    Worn {
        joint: usize,
        centre: f64,
        half: f64,
    },
}

impl Withheld {
    /// Adds the effect in this size to a plant.
    ///
    /// # Errors
    /// The altered bodies make no possible robot.
    pub fn apply(&self, size: f64, build: &mut Build) -> Result<(), RobotError> {
        let eps = |build: &Build, j: usize| build.friction[build.axes[j]].v_eps;
        let axis = |build: &Build, j: usize| build.axes[j];
        let mut add: Option<Box<dyn Mechanism>> = None;
        match self {
            Self::Link {
                link,
                mass,
                shift,
                inertia,
            } => {
                let link = axis(build, *link);
                let body = &mut build.arm.joints[link].link.inertia;
                *body = altered(body, 1.0 + size * mass, shift * size, 1.0 + size * inertia);
            }
            Self::Friction { joints } => {
                for (j, coulomb, viscous) in joints {
                    let friction = &mut build.friction[build.axes[*j]];
                    friction.coulomb *= (1.0 + size * coulomb).max(0.05);
                    friction.viscous *= (1.0 + size * viscous).max(0.05);
                }
            }
            Self::Payload { com, gyration } => {
                let about_com = Matrix3::identity() * (size * gyration * gyration);
                build.arm.attach(&Inertia::from_com(size, *com, about_com));
            }
            Self::Rotor { joint } => {
                let j = axis(build, *joint);
                build.armature[j] += size;
            }
            Self::Tilt { direction } => {
                build
                    .arm
                    .tilt(Vector3::new(direction.cos(), direction.sin(), 0.0) * size);
            }
            Self::Gas {
                joint,
                pins,
                volume,
            } => {
                add = Some(Box::new(GasStrut {
                    joint: axis(build, *joint),
                    pins: *pins,
                    force: size,
                    volume: *volume,
                }));
            }
            Self::Coil { joint, pins, free } => {
                add = Some(Box::new(CoilSpring {
                    joint: axis(build, *joint),
                    pins: *pins,
                    stiffness: size,
                    free: *free,
                }));
            }
            Self::Asymmetric {
                joint,
                coulomb,
                viscous,
            } => {
                add = Some(Box::new(AsymmetricFriction {
                    joint: axis(build, *joint),
                    coulomb: size * coulomb,
                    viscous: size * viscous,
                    v_eps: eps(build, *joint),
                }));
            }
            Self::Stribeck { joint, v_s, law } => {
                add = Some(Box::new(Stribeck {
                    joint: axis(build, *joint),
                    size,
                    v_s: *v_s,
                    v_eps: eps(build, *joint),
                    kind: *law,
                    film: 0.0,
                }));
            }
            Self::Drag {
                joint,
                v_0,
                v_top,
                law,
            } => {
                add = Some(Box::new(Drag {
                    joint: axis(build, *joint),
                    size,
                    v_0: *v_0,
                    v_top: *v_top,
                    kind: *law,
                }));
            }
            Self::Mesh { joint } => {
                add = Some(Box::new(GearMesh {
                    joint: axis(build, *joint),
                    loss: size,
                    v_eps: eps(build, *joint),
                }));
            }
            Self::Runout {
                joint,
                order,
                phase,
                viscous,
                law,
            } => {
                add = Some(Box::new(RunoutFriction {
                    joint: axis(build, *joint),
                    size,
                    viscous: *viscous,
                    order: *order,
                    phase: *phase,
                    v_eps: eps(build, *joint),
                    kind: *law,
                }));
            }
            Self::Bristle {
                joint,
                elastic,
                more,
                damping,
            } => {
                let j = axis(build, *joint);
                // The bristles carry what was the joint's Coulomb friction.
                let coulomb = std::mem::take(&mut build.friction[j].coulomb) * (1.0 + more);
                add = Some(Box::new(Bristle {
                    joint: j,
                    coulomb,
                    deflection: size,
                    elastic: *elastic,
                    damping: *damping,
                    z: 0.0,
                }));
            }
            Self::Warm {
                joint,
                fading,
                time,
                coulomb,
                power,
            } => {
                let j = axis(build, *joint);
                let friction = build.friction[j];
                add = Some(Box::new(WarmingGrease {
                    joint: j,
                    cold: size,
                    fading: *fading,
                    time: *time,
                    power: *power,
                    viscous: friction.viscous,
                    coulomb: friction.coulomb * coulomb,
                    v_eps: friction.v_eps,
                    warmth: 0.0,
                }));
            }
            Self::Ripple { joint, waves } => {
                add = Some(Box::new(Ripple {
                    joint: axis(build, *joint),
                    waves: waves.iter().map(|[n, a, p]| [*n, a * size, *p]).collect(),
                }));
            }
            Self::Elastic {
                joint,
                hardening,
                ratio,
            } => {
                let disc = build.arm.disc[*joint];
                let gear = build.split(*joint);
                let stiffness = 1.0 / size;
                add = Some(Box::new(GearSpring {
                    joint: gear,
                    stiffness,
                    hardening: *hardening,
                    damping: 2.0 * ratio * (stiffness * disc).sqrt(),
                }));
            }
            Self::Play { joint, stiffness } => {
                let critical = (stiffness * build.arm.disc[*joint]).sqrt();
                let gear = build.split(*joint);
                add = Some(Box::new(GearPlay {
                    joint: gear,
                    half: size,
                    stiffness: *stiffness,
                    damping: 0.5 * critical,
                    grease: 0.003 * critical,
                }));
            }
            Self::Coupling {
                driver,
                driven,
                law,
            } => {
                add = Some(Box::new(Coupling {
                    driver: axis(build, *driver),
                    driven: axis(build, *driven),
                    size,
                    v_eps: eps(build, *driver),
                    kind: *law,
                }));
            }
            Self::Gain { joint, sign } => build.measurement.gain[*joint] = 1.0 + sign * size,
            Self::Offset { joint, sign } => build.measurement.offset[*joint] = sign * size,
            Self::Delay { sign } => build.measurement.delay = sign * size,
            Self::Saturation { joint, greatest } => {
                build.measurement.limit[*joint] = greatest * (1.0 - size);
            }
            Self::Zero { joint, sign } => {
                let j = axis(build, *joint);
                build.arm.shift_zero(j, sign * size);
            }
            Self::Contact { point, grabs } => {
                let grabs = grabs.iter().map(|g| Grab {
                    stiffness: g.stiffness * size,
                    damping: g.damping * size,
                    limit: g.limit * size,
                    ..*g
                });
                add = Some(Box::new(ToolContact::new(
                    build.arm.robot()?,
                    *point,
                    grabs.collect(),
                )));
            }
            Self::CrossDrag { joints, ratio } => {
                add = Some(Box::new(CrossDrag {
                    joints: joints.map(|j| axis(build, j)),
                    size: [size * ratio, size],
                }));
            }
            Self::CableTug {
                joints,
                centre,
                ratio,
                slack,
            } => {
                add = Some(Box::new(CableTug {
                    joints: joints.map(|j| axis(build, j)),
                    centre: *centre,
                    ratio: *ratio,
                    slack: *slack,
                    size,
                }));
            }
            Self::Mount {
                axis,
                below,
                mass,
                ratio,
            } => {
                build.arm.put_on_hinge(*axis, *below, *mass, 0.3);
                build.insert(0);
                let height = build
                    .arm
                    .joints
                    .iter()
                    .map(|j| j.link.inertia.mass)
                    .sum::<f64>();
                let stiffness = 1.0 / size;
                add = Some(Box::new(SpringDamper {
                    joint: 0,
                    stiffness,
                    damping: 2.0 * ratio * (stiffness * height * below * below).sqrt(),
                }));
            }
            Self::Dropouts { joint, times } => {
                add = Some(Box::new(Dropouts {
                    joint: axis(build, *joint),
                    depth: size,
                    times: times.clone(),
                }));
            }
            Self::Hum {
                joint,
                frequency,
                swell,
            } => {
                add = Some(Box::new(FloorHum {
                    joint: axis(build, *joint),
                    size,
                    frequency: *frequency,
                    swell: *swell,
                }));
            }
            Self::Tank {
                joint,
                frequency,
                damping,
            } => {
                add = Some(Box::new(SloshingTank {
                    joint: axis(build, *joint),
                    inertia: size,
                    frequency: *frequency,
                    damping: *damping,
                    angle: 0.0,
                    rate: 0.0,
                }));
            }
            Self::Wander { joint, step, knots } => {
                add = Some(Box::new(WanderingOffset {
                    joint: axis(build, *joint),
                    size,
                    start: -5.0,
                    step: *step,
                    knots: knots.clone(),
                }));
            }
            Self::Worn {
                joint,
                centre,
                half,
            } => {
                add = Some(Box::new(WornSector {
                    joint: axis(build, *joint),
                    size,
                    centre: *centre,
                    half: *half,
                    v_eps: eps(build, *joint),
                }));
            }
        }
        build.mechanisms.extend(add);
        Ok(())
    }
}
