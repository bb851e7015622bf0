//! Catalogue of effects that a simulator may lack, as hypotheses: the parameters that each frees and their prior
//! deviations.

use crate::arm::Arm;
use crate::given::Given;
use crate::parameter::{Kind, Parameter};
use crate::smooth::{FUNCTIONS, Smooth};
use crate::tracks::Replayed;
use nalgebra::{DMatrix, DVector};
use physics::dynamics::{Workspace, inverse_dynamics, mass_matrix};

/// Effect that a simulator may lack or hold with wrong values.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Effect {
    /// Proportional gain of the joint's drive differs from the given one.
    ServoGain,
    /// Derivative gain of the joint's drive differs from the given one.
    ServoDamping,
    /// Commands reach the drives after a delay, or through a low-pass filter.
    CommandDelay,
    /// Limit of the torque of the joint's drive differs from the given one.
    EffortLimit,
    /// Drives add another part of the gravity torque than given.
    GravityCompensation,
    /// Viscous and Coulomb friction of the joint differ from the given values.
    FrictionParameters,
    /// Dry friction of the joint is higher near standstill.
    StribeckFriction,
    /// Dry friction of the joint grows with the torque that its gear transmits.
    LoadDependentFriction,
    /// Rotor inertia of the joint differs from the given one.
    RotorInertia,
    /// Inertial parameters of the joint's link are off by a common factor.
    LinkParameters,
    /// Body that the description lacks is attached to the last link.
    Payload,
    /// Zero of the joint's encoder, or of its command, is shifted.
    EncoderOffset,
    /// Direction of gravity in the base frame differs, because the base is tilted.
    BaseTilt,
    /// Link of the joint turns with the motor of a neighbouring joint, too.
    JointCoupling,
    /// Smooth torque on the joint that no other effect explains.
    Unknown,
}

impl Effect {
    /// All effects but the unknown torque: those that the search compares by name.
    pub const ALL: [Self; 14] = [
        Self::ServoGain,
        Self::ServoDamping,
        Self::CommandDelay,
        Self::EffortLimit,
        Self::GravityCompensation,
        Self::FrictionParameters,
        Self::StribeckFriction,
        Self::LoadDependentFriction,
        Self::RotorInertia,
        Self::LinkParameters,
        Self::Payload,
        Self::EncoderOffset,
        Self::BaseTilt,
        Self::JointCoupling,
    ];

    /// Name of the effect in the report, such as `servo_gain`.
    pub fn name(self) -> &'static str {
        match self {
            Self::ServoGain => "servo_gain",
            Self::ServoDamping => "servo_damping",
            Self::CommandDelay => "command_delay",
            Self::EffortLimit => "effort_limit",
            Self::GravityCompensation => "gravity_compensation",
            Self::FrictionParameters => "friction_parameters",
            Self::StribeckFriction => "stribeck_friction",
            Self::LoadDependentFriction => "load_dependent_friction",
            Self::RotorInertia => "rotor_inertia",
            Self::LinkParameters => "link_parameters",
            Self::Payload => "payload",
            Self::EncoderOffset => "encoder_offset",
            Self::BaseTilt => "base_tilt",
            Self::JointCoupling => "joint_coupling",
            Self::Unknown => "unknown",
        }
    }

    /// Words for the effect in texts that a person reads.
    pub fn words(self) -> &'static str {
        match self {
            Self::ServoGain => "gain of the servo",
            Self::ServoDamping => "damping by the servo",
            Self::CommandDelay => "commands that reach the joints late",
            Self::EffortLimit => "limit of the drive's torque",
            Self::GravityCompensation => "gravity compensation inside the drive",
            Self::FrictionParameters => "viscous and Coulomb friction",
            Self::StribeckFriction => "Stribeck friction",
            Self::LoadDependentFriction => "friction that grows with torque",
            Self::RotorInertia => "rotor inertia (armature)",
            Self::LinkParameters => "masses of the links",
            Self::Payload => "payload at the last link",
            Self::EncoderOffset => "zero of the joint or of its command",
            Self::BaseTilt => "tilt of the base",
            Self::JointCoupling => "coupling to another joint's motor",
            Self::Unknown => "an effect that the catalogue lacks",
        }
    }
}

/// Parameter of a hypothesis with its prior standard deviation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sized {
    /// Parameter that the hypothesis frees.
    pub parameter: Parameter,
    /// Prior standard deviation of the parameter's coordinate (see [`Scale`](crate::parameter::Scale)) about the given
    /// value.
    pub deviation: f64,
}

/// Effect at one place (a joint or the whole arm) as a hypothesis of the search.
#[derive(Debug, Clone, PartialEq)]
pub struct Mechanism {
    /// Effect that acts there.
    pub effect: Effect,
    /// Index of the joint; none for an effect of the whole arm.
    pub joint: Option<usize>,
    /// Parameters that the hypothesis frees, each with its prior standard deviation.
    pub parameters: Vec<Sized>,
}

impl Mechanism {
    /// Index of the joint whose motor turns this mechanism's link, too; none but for a coupling.
    pub fn driver(&self) -> Option<usize> {
        let of = |sized: &Sized| match sized.parameter.kind {
            Kind::Coupling(motor) => Some(motor),
            _ => None,
        };
        self.parameters.iter().find_map(of)
    }
}

/// Typical torque, inertia and speed of each joint in the recorded motion. Prior deviations of effects are multiples of
/// them.
#[derive(Debug, Clone)]
pub struct Sizes {
    /// Typical torque of each joint, N·m: RMS of gravity together with acceleration to its RMS speed within 0.25 s. It
    /// is at least a tenth of the largest joint's.
    pub torque: Vec<f64>,
    /// Mean inertia that each joint moves, kg·m²: diagonal entry of the mass matrix plus rotor inertia.
    pub inertia: Vec<f64>,
    /// RMS velocity of each joint, rad/s, at least 0.001.
    pub speed: Vec<f64>,
    /// Mass of all links of the given description together, kg.
    pub mass: f64,
    /// Median time between samples of the recording, s, which stands for the period of its commands.
    pub period: f64,
    /// Lowest and highest recorded position of each joint, rad (m).
    pub range: Vec<[f64; 2]>,
}

impl Sizes {
    /// Typical sizes of the given arm over the recorded motion.
    pub fn of(given: &Given, replayed: &Replayed) -> Self {
        let arm = &given.arm;
        let n = arm.dof();
        let mut workspace = Workspace::new(&arm.robot);
        let (mut torque, mut inertia, mut speed) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        let (mut tau, mut mass, zero) = (vec![0.0; n], vec![0.0; n * n], vec![0.0; n]);
        let (mut count, mut steps) = (0.0, Vec::new());
        let mut range = vec![[f64::INFINITY, f64::NEG_INFINITY]; n];
        for track in &replayed.whole {
            for row in 1..track.time.len() {
                let dt = track.time[row] - track.time[row - 1];
                steps.push(dt);
                for (own, q) in range.iter_mut().zip(track.q.row(row)) {
                    *own = [own[0].min(*q), own[1].max(*q)];
                }
                for (j, speed) in speed.iter_mut().enumerate() {
                    *speed += ((track.q[(row, j)] - track.q[(row - 1, j)]) / dt).powi(2);
                }
                count += 1.0;
                // Gravity and inertia change slowly, so that every twentieth sample is enough.
                if row % 20 != 1 {
                    continue;
                }
                let q = track.q.row(row).to_vec();
                inverse_dynamics(&arm.robot, &mut workspace, &q, &zero, &zero, &mut tau);
                mass_matrix(&arm.robot, &mut workspace, &q, &mut mass);
                for j in 0..n {
                    torque[j] += 20.0 * tau[j].powi(2);
                    inertia[j] += 20.0 * (mass[j * n + j] + arm.joints[j].armature);
                }
            }
        }
        steps.sort_by(f64::total_cmp);
        let period = steps.get(steps.len() / 2).copied().unwrap_or(0.01);
        for j in 0..n {
            speed[j] = (speed[j] / count).sqrt().max(1e-3);
            inertia[j] /= count;
            // Acceleration to the joint's RMS speed within a quarter of a second, a typical time of a joint.
            let accelerating = inertia[j] * speed[j] / 0.25;
            torque[j] = ((torque[j] / count) + accelerating.powi(2)).sqrt();
        }
        // Lower bound for joints without gravity load: their motors are of a kind with their neighbours'.
        let largest = torque.iter().copied().fold(0.0, f64::max);
        for t in &mut torque {
            *t = t.max(0.1 * largest);
        }
        let parameters = arm.given.parameters();
        Self {
            torque,
            inertia,
            speed,
            mass: parameters
                .iter()
                .step_by(physics::robot::PARAMETERS_PER_LINK)
                .sum(),
            period,
            range,
        }
    }

    /// Arm whose smooth unknown torques are scaled by what each joint does: range, usual speed and usual torque.
    pub fn scaled(&self, arm: &Arm) -> Arm {
        let mut out = arm.clone();
        for (j, joint) in out.joints.iter_mut().enumerate() {
            // What earlier recordings have shown keeps its meaning.
            if joint.unknown.acts() {
                continue;
            }
            let [low, high] = self.range[j];
            joint.unknown.low = low;
            // A joint that holds still gives waves no range.
            joint.unknown.width = (high - low).max(1e-3);
            joint.unknown.speed = self.speed[j];
            joint.unknown.torque = self.torque[j];
        }
        out
    }
}

/// Prior standard deviation of the logarithm of a wrong gain or limit: a factor of about e.
const FACTOR: f64 = 1.0;

/// All mechanisms that could explain the motion of this arm. Parameters that are free in any case (`Given::free`) are
/// left out, and so are joints that do not move.
pub fn mechanisms(given: &Given, replayed: &Replayed, sizes: &Sizes) -> Vec<Mechanism> {
    let arm = &given.arm;
    let n = arm.dof();
    let rates = replayed.whole.iter().all(|t| t.rates.is_some());
    let mut all = Vec::new();
    let mut add = |effect: Effect, joint: Option<usize>, list: &[(Kind, f64)]| {
        let parameters: Vec<Sized> = list
            .iter()
            .map(|&(kind, deviation)| Sized {
                parameter: Parameter::new(kind, joint.unwrap_or(0)),
                deviation,
            })
            .filter(|s| !given.is_free(s.parameter))
            .collect();
        if !parameters.is_empty() {
            all.push(Mechanism {
                effect,
                joint,
                parameters,
            });
        }
    };
    // Prior deviation of a delay: two periods of the commands, or 20 ms. A user notices longer ones.
    let late = (2.0 * sizes.period).max(0.02);
    add(Effect::CommandDelay, None, &[(Kind::CommonDelay, late)]);
    add(
        Effect::GravityCompensation,
        None,
        &[(Kind::GravityCompensation, 0.5)],
    );
    let body = 0.2 * sizes.mass;
    let arm_length = 0.1;
    add(
        Effect::Payload,
        None,
        &[
            (Kind::Payload(0), body),
            (Kind::Payload(1), body * arm_length),
            (Kind::Payload(2), body * arm_length),
            (Kind::Payload(3), body * arm_length),
            (Kind::Payload(4), body * arm_length.powi(2)),
        ],
    );
    add(
        Effect::BaseTilt,
        None,
        &[(Kind::Tilt(0), 0.05), (Kind::Tilt(1), 0.05)],
    );
    for j in (0..n).filter(|&j| replayed.moves[j]) {
        let torque = sizes.torque[j];
        add(Effect::ServoGain, Some(j), &[(Kind::Gain, FACTOR)]);
        let viscous = torque / sizes.speed[j];
        if rates {
            add(
                Effect::ServoDamping,
                Some(j),
                &[(Kind::ServoDamping, viscous)],
            );
        }
        add(
            Effect::FrictionParameters,
            Some(j),
            &[(Kind::Damping, viscous), (Kind::Coulomb, torque)],
        );
        add(
            Effect::RotorInertia,
            Some(j),
            &[(Kind::Armature, sizes.inertia[j])],
        );
        add(
            Effect::StribeckFriction,
            Some(j),
            &[
                (Kind::Stribeck, 0.5 * torque),
                (Kind::StribeckVelocity, FACTOR),
            ],
        );
        add(Effect::LoadDependentFriction, Some(j), &[(Kind::Load, 0.3)]);
        // Delay of the joint: on the way to the drive, or by the drive's own filter.
        add(
            Effect::CommandDelay,
            Some(j),
            &[(Kind::Delay, late), (Kind::Lag, late)],
        );
        add(
            Effect::EncoderOffset,
            Some(j),
            &[(Kind::Offset, 0.05), (Kind::Zero, 0.05)],
        );
        add(Effect::LinkParameters, Some(j), &[(Kind::LinkScale, 0.3)]);
        // Wheels of one size would make a whole turn per turn. Motors are coupled along the arm, from a joint to the next.
        for motor in [j.wrapping_sub(1), j + 1] {
            if motor < n && replayed.moves[motor] {
                add(
                    Effect::JointCoupling,
                    Some(j),
                    &[(Kind::Coupling(motor), 0.3)],
                );
            }
        }
        let limit = arm.get(Parameter::new(given.limit(), j));
        if limit.is_finite() {
            add(Effect::EffortLimit, Some(j), &[(given.limit(), FACTOR)]);
        }
        let unknown: Vec<(Kind, f64)> = (0..FUNCTIONS)
            .map(|k| (Kind::Unknown(k), torque * Smooth::weight(k)))
            .collect();
        add(Effect::Unknown, Some(j), &unknown);
    }
    all
}

/// Correlation matrix of a covariance matrix.
pub fn correlations(covariance: &DMatrix<f64>) -> DMatrix<f64> {
    let deviation = DVector::from_iterator(
        covariance.nrows(),
        covariance
            .diagonal()
            .iter()
            .map(|v| v.max(f64::MIN_POSITIVE).sqrt()),
    );
    DMatrix::from_fn(covariance.nrows(), covariance.ncols(), |i, k| {
        covariance[(i, k)] / (deviation[i] * deviation[k])
    })
}
