//! The sealed answer of a case.

use super::oracle::Oracle;
use super::withheld::Withheld;
use crate::mechanism::{CouplingKind, DragKind, Runout, StribeckKind};
use serde::Serialize;
use serde_json::{Value, json};

/// The answer of a case, as `truth/ID.json` holds it.
#[derive(Debug, Clone, Serialize)]
pub struct Truth {
    /// Name of the case.
    pub case: String,
    /// Name of its [`super::Kind`].
    pub kind: String,
    /// Family of its robot.
    pub robot: String,
    /// Seed of the run, index of the case, attempt that succeeded.
    pub seed: [u64; 3],
    /// Number of joints.
    pub joints: usize,
    /// Withheld effects.
    pub effects: Vec<TruthEffect>,
    /// Root mean square of the torque without noise per joint, over all samples, N·m.
    pub torque_rms: Vec<f64>,
    /// The same of all effects together.
    pub effect_rms: Vec<f64>,
    /// What base parameters, Coulomb and viscous friction leave of them.
    pub unabsorbed_rms: Vec<f64>,
    /// Root mean square of the torque noise.
    pub noise_rms: Vec<f64>,
    /// Speed below which the plant's friction is softened, rad/s.
    pub v_eps: Vec<f64>,
    /// The best that can be had on the held-out recording.
    pub oracle: Oracle,
    /// The plant without the effect.
    pub plant: PlantTruth,
    /// Time that the case took to make, s.
    pub seconds: f64,
}

/// Parameters of the plant without the effect.
#[derive(Debug, Clone, Serialize)]
pub struct PlantTruth {
    /// Standard parameters of each link (inertia about the joint's origin).
    pub inertias: Vec<Vec<f64>>,
    /// Coulomb friction, N·m.
    #[serde(rename = "Fc")]
    pub coulomb: Vec<f64>,
    /// Viscous friction, N·m·s/rad.
    #[serde(rename = "Fv")]
    pub viscous: Vec<f64>,
}

/// One withheld effect.
#[derive(Debug, Clone, Serialize)]
pub struct TruthEffect {
    /// Name in the contract's table; `unknown` for one outside it.
    pub effect: String,
    /// Mechanism that made it.
    pub mechanism: String,
    /// `joint` where it belongs to joints, `global` where it belongs to the arm.
    pub scope: String,
    /// Joints whose torque it changes.
    pub joints: Vec<String>,
    /// Joint on which its shares are taken.
    pub reference_joint: String,
    /// Size, in the unit of the mechanism.
    pub level: f64,
    /// Its parameters.
    pub parameters: Value,
    /// Root mean square of its torque over that of the joint's.
    pub share: f64,
    /// The same after base parameters, Coulomb and viscous friction have taken what they can.
    pub share_after_reidentification: f64,
    /// That part over the torque noise.
    pub snr_after_reidentification: f64,
    /// Effects that no recording can tell from it.
    pub indistinguishable: Vec<String>,
}

/// What is said of an effect beside its figures.
pub struct Description {
    /// Mechanism.
    pub mechanism: &'static str,
    /// Joints that the effect belongs to; none: the whole arm.
    pub joints: Option<Vec<usize>>,
    /// Parameters.
    pub parameters: Value,
    /// Effects that no recording can tell from it.
    pub indistinguishable: Vec<&'static str>,
}

/// Describes an effect of a given size on an arm with `dof` joints.
pub fn describe(effect: &Withheld, size: f64, dof: usize) -> Description {
    let last = dof - 1;
    let (mechanism, joints, parameters, indistinguishable): (
        _,
        Option<Vec<usize>>,
        _,
        Vec<&'static str>,
    ) = match effect {
        Withheld::Link {
            link,
            mass,
            shift,
            inertia,
        } => {
            let same = if *link == last {
                vec!["payload"]
            } else {
                vec![]
            };
            let values = json!({"link": link + 1, "mass_factor": 1.0 + size * mass, "com_shift": (shift * size).as_slice(),
                "inertia_factor": 1.0 + size * inertia});
            ("link_parameters", None, values, same)
        }
        Withheld::Friction { joints } => {
            let factors: Vec<Value> = joints
                .iter()
                .map(|(j, c, v)| {
                    json!({"joint": name(*j), "coulomb_factor": (1.0 + size * c).max(0.05),
                "viscous_factor": (1.0 + size * v).max(0.05)})
                })
                .collect();
            let on = joints.iter().map(|j| j.0).collect();
            (
                "friction_parameters",
                Some(on),
                json!({"factors": factors}),
                vec![],
            )
        }
        Withheld::Payload { com, gyration } => {
            let values = json!({"mass": size, "com": com.as_slice(), "gyration": gyration});
            ("payload", None, values, vec!["link_parameters"])
        }
        Withheld::Rotor { joint } => {
            // The first link turns only about its joint: there both inertias are one.
            let same = if *joint == 0 {
                vec!["link_parameters"]
            } else {
                vec![]
            };
            (
                "rotor_inertia",
                Some(vec![*joint]),
                json!({"inertia": size}),
                same,
            )
        }
        Withheld::Tilt { direction } => {
            let values =
                json!({"tilt_x": size * direction.cos(), "tilt_y": size * direction.sin()});
            ("base_tilt", None, values, vec![])
        }
        Withheld::Gas {
            joint,
            pins,
            volume,
        } => {
            let values = json!({"force": size, "lever": pins.lever, "base": pins.base, "angle": pins.angle,
                "volume": volume});
            ("gas_strut", Some(vec![*joint]), values, vec![])
        }
        Withheld::Coil { joint, pins, free } => {
            let values = json!({"stiffness": size, "lever": pins.lever, "base": pins.base, "angle": pins.angle,
                "free": free});
            ("coil_spring", Some(vec![*joint]), values, vec![])
        }
        Withheld::Asymmetric {
            joint,
            coulomb,
            viscous,
        } => {
            let values = json!({"coulomb": coulomb * size, "viscous": viscous * size});
            // Without a viscous part the joint only pulls to one side.
            let same = if *viscous == 0.0 {
                vec!["torque_offset"]
            } else {
                vec![]
            };
            ("asymmetric_friction", Some(vec![*joint]), values, same)
        }
        Withheld::Stribeck { joint, v_s, law } => {
            let (mechanism, values) = match law {
                StribeckKind::Lorentz => {
                    ("stribeck_lorentz", json!({"stribeck": size, "v_s": v_s}))
                }
                StribeckKind::HalfCosine => (
                    "stribeck_half_cosine",
                    json!({"stribeck": size, "v_s": v_s}),
                ),
                StribeckKind::Film(time) => (
                    "lubricant_film",
                    json!({"stribeck": size, "v_s": v_s, "time": time}),
                ),
            };
            (mechanism, Some(vec![*joint]), values, vec![])
        }
        Withheld::Drag {
            joint,
            v_0,
            v_top,
            law,
        } => {
            let mechanism = match law {
                DragKind::Eyring => "eyring_flow",
                DragKind::Churning => "churning_oil",
                DragKind::Carreau => "shear_thinning",
                DragKind::Power(_) => "power_law",
            };
            let values = json!({"size": size, "v_0": v_0, "v_top": v_top});
            (mechanism, Some(vec![*joint]), values, vec![])
        }
        Withheld::Mesh { joint } => (
            "gear_mesh",
            Some(vec![*joint]),
            json!({"loss": size}),
            vec![],
        ),
        Withheld::Runout {
            joint,
            order,
            phase,
            viscous,
            law,
        } => {
            let mechanism = match law {
                Runout::BentShaft(_) => "bent_shaft",
                Runout::Eccentric => "eccentric_gear",
            };
            let values =
                json!({"friction": size, "order": order, "phase": phase, "viscous": viscous});
            (mechanism, Some(vec![*joint]), values, vec![])
        }
        Withheld::Bristle {
            joint,
            elastic,
            more,
            ..
        } => {
            let values =
                json!({"deflection": size, "elastic": elastic, "coulomb_factor": 1.0 + more});
            ("bristles", Some(vec![*joint]), values, vec![])
        }
        Withheld::Warm {
            joint,
            fading,
            time,
            coulomb,
            ..
        } => {
            let values =
                json!({"cold": size, "fading": fading, "time": time, "coulomb_share": coulomb});
            ("warming_grease", Some(vec![*joint]), values, vec![])
        }
        Withheld::Ripple { joint, waves } => {
            let column = |i: usize| waves.iter().map(|w| w[i]).collect::<Vec<f64>>();
            let values = json!({"order": column(0), "amplitude": waves.iter().map(|w| w[1] * size).collect::<Vec<f64>>(),
                "phase": column(2)});
            ("torque_ripple", Some(vec![*joint]), values, vec![])
        }
        Withheld::Elastic {
            joint,
            hardening,
            ratio,
            ..
        } => {
            let values =
                json!({"stiffness": 1.0 / size, "hardening": hardening, "damping_ratio": ratio});
            ("gear_spring", Some(vec![*joint]), values, vec![])
        }
        Withheld::Play {
            joint, stiffness, ..
        } => {
            let values = json!({"play": 2.0 * size, "flank_stiffness": stiffness});
            ("gear_play", Some(vec![*joint]), values, vec![])
        }
        Withheld::Coupling {
            driver,
            driven,
            law,
        } => {
            let (mechanism, values) = match law {
                CouplingKind::Viscous => (
                    "shared_oil",
                    json!({"driver": name(*driver), "viscous": size}),
                ),
                CouplingKind::Seal(ratio) => (
                    "shared_seal",
                    json!({"driver": name(*driver), "coulomb": size, "ratio": ratio}),
                ),
                CouplingKind::Wheel => (
                    "shared_wheel",
                    json!({"driver": name(*driver), "inertia": size}),
                ),
            };
            (mechanism, Some(vec![*driven]), values, vec![])
        }
        Withheld::Gain { joint, sign } => (
            "torque_gain",
            Some(vec![*joint]),
            json!({"gain": 1.0 + sign * size}),
            vec![],
        ),
        Withheld::Offset { joint, sign } => (
            "torque_offset",
            Some(vec![*joint]),
            json!({"offset": sign * size}),
            vec!["asymmetric_friction"],
        ),
        Withheld::Delay { sign } => ("time_delay", None, json!({"delay": sign * size}), vec![]),
        Withheld::Saturation { joint, greatest } => (
            "saturation",
            Some(vec![*joint]),
            json!({"limit": greatest * (1.0 - size)}),
            vec![],
        ),
        Withheld::Zero { joint, sign } => {
            // Turning the last link's frame turns its mass distribution, nothing else.
            let same = if *joint == last {
                vec!["link_parameters"]
            } else {
                vec![]
            };
            (
                "encoder_offset",
                Some(vec![*joint]),
                json!({"zero": sign * size}),
                same,
            )
        }
        Withheld::Contact { grabs, point } => {
            let times: Vec<[f64; 2]> = grabs.iter().map(|g| [g.start, g.end]).collect();
            let values = json!({"scale": size, "point": point.as_slice(), "times": times});
            ("tool_held", None, values, vec![])
        }
        Withheld::CrossDrag { joints, .. } => {
            ("cross_drag", Some(joints.to_vec()), json!({}), vec![])
        }
        Withheld::CableTug { joints, .. } => {
            ("cable_tug", Some(joints.to_vec()), json!({}), vec![])
        }
        Withheld::Mount { .. } => (
            "flexible_mount",
            None,
            json!({"stiffness": 1.0 / size}),
            vec![],
        ),
        Withheld::Dropouts { joint, .. } => (
            "torque_dropouts",
            Some(vec![*joint]),
            json!({"depth": size}),
            vec![],
        ),
        Withheld::Hum {
            joint, frequency, ..
        } => (
            "floor_hum",
            Some(vec![*joint]),
            json!({"frequency": frequency}),
            vec![],
        ),
        Withheld::Tank {
            joint, frequency, ..
        } => (
            "sloshing_tank",
            Some(vec![*joint]),
            json!({"frequency": frequency}),
            vec![],
        ),
        Withheld::Wander { joint, step, .. } => (
            "wandering_torque",
            Some(vec![*joint]),
            json!({"step": step}),
            vec![],
        ),
        Withheld::Worn {
            joint,
            centre,
            half,
        } => (
            "worn_sector",
            Some(vec![*joint]),
            json!({"centre": centre, "half": half}),
            vec![],
        ),
    };
    Description {
        mechanism,
        joints,
        parameters,
        indistinguishable,
    }
}

/// Name of a joint from its index.
pub fn name(joint: usize) -> String {
    format!("joint{}", joint + 1)
}
