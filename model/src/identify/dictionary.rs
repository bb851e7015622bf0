//! Dictionary of terms from which cross-validation chooses, for one joint.

use physics::effects::{
    Dahl, FrictionShape, Harmonic, LaggedSign, LoadFriction, Phase, PositionFriction, Sliding,
    Stop, Term, WarmUp,
};

/// Terms that every joint has: offset, viscous and Coulomb friction.
///
/// Rotor inertia is added where the rigid body does not contain it already.
pub fn basic() -> Vec<Term> {
    vec![
        Term::Offset,
        Term::Sliding(Sliding::Viscous),
        Term::Sliding(Sliding::Coulomb),
    ]
}

/// Whether a term is a shape of friction, whose size is limited relative to the joint's friction. Similar
/// curves cancel, and hundreds of N·m of one against hundreds of another are unphysical.
pub fn is_friction_shape(term: &Term) -> bool {
    match term {
        Term::Sliding(_)
        | Term::EarlySign(_)
        | Term::Stop(_)
        | Term::Dahl(_)
        | Term::DahlRate(_)
        | Term::LaggedSign(_)
        | Term::Position(_) => true,
        Term::Offset
        | Term::RotorInertia
        | Term::Load(_)
        | Term::Harmonic(_)
        | Term::Polynomial(_)
        | Term::Coupling(_)
        | Term::Counterbalance(_)
        | Term::Spring(_)
        | Term::WarmUp(_)
        | Term::Drift(_) => false,
    }
}

/// Whether a term is a torque of the joint's position, which over a part of a turn is nearly an offset.
pub fn is_torque_of_position(term: &Term) -> bool {
    matches!(term, Term::Harmonic(_))
}

/// Clock of the training recordings, for warm-up terms.
#[derive(Clone, Copy, Debug)]
pub struct SessionClock {
    /// First time stamp of the session, s.
    pub start: f64,
    /// Last time stamp of the session, s.
    pub end: f64,
}

/// Candidate terms of one joint. `revolute` says whether its position is an angle: only then are there terms that
/// repeat with it.
///
/// The grids span what drives show: Stribeck velocities of 0.5–8°/s, presliding displacements of
/// 0.0005–3°, lags of 0.1–3 s. A warm-up term needs a session of at least half its time constant (6–60 min).
pub fn candidates(revolute: bool, clock: SessionClock) -> Vec<Term> {
    let degree = std::f64::consts::PI / 180.0;
    let stribeck = |v: f64| Sliding::Stribeck {
        velocity: v * degree,
    };
    let degressive = |v: f64| Sliding::Degressive {
        velocity: v * degree,
    };
    let mut terms = vec![
        Term::Sliding(Sliding::AsymmetricViscous),
        Term::Sliding(Sliding::Power { exponent: 0.5 }),
        Term::Sliding(Sliding::Power { exponent: 2.0 }),
    ];
    terms.extend([0.5, 1.0, 2.0, 4.0, 8.0].map(|v| Term::Sliding(stribeck(v))));
    terms.extend([4.0, 8.0, 15.0, 30.0].map(|v| Term::Sliding(degressive(v))));
    terms.extend(
        [0.0005, 0.002, 0.01, 0.05, 0.2, 1.0, 3.0].map(|w| Term::Stop(Stop { width: w * degree })),
    );
    terms.extend(
        [30.0, 100.0, 300.0, 1e3, 3e3, 1e4, 3e4].map(|stiffness| Term::Dahl(Dahl { stiffness })),
    );
    terms.extend([0.1, 0.3, 1.0, 3.0].map(|time_constant| {
        Term::LaggedSign(LaggedSign {
            time_constant,
            standstill: 3e-4,
        })
    }));
    let shapes = [
        FrictionShape::Sliding(Sliding::Coulomb),
        FrictionShape::Sliding(Sliding::Viscous),
        FrictionShape::Sliding(stribeck(2.0)),
        FrictionShape::Dahl(Dahl { stiffness: 1e3 }),
        FrictionShape::Dahl(Dahl { stiffness: 1e4 }),
    ];
    terms.extend(shapes.map(|friction| Term::Load(LoadFriction::linear(friction))));
    if revolute {
        for order in [1.0, 2.0, 3.0] {
            for phase in [Phase::Sin, Phase::Cos] {
                let harmonic = Harmonic { order, phase };
                terms.push(Term::Harmonic(harmonic));
                for friction in [shapes[0], shapes[1], shapes[4]] {
                    terms.push(Term::Position(PositionFriction { harmonic, friction }));
                }
            }
        }
    }
    for time_constant in [360.0, 1200.0, 3600.0] {
        let length = clock.end - clock.start;
        if length < time_constant / 2.0 {
            continue;
        }
        let warming = [
            Term::Sliding(Sliding::Viscous),
            Term::Sliding(Sliding::Coulomb),
            Term::Sliding(degressive(8.0)),
            Term::Sliding(stribeck(2.0)),
            Term::Dahl(Dahl { stiffness: 1e4 }),
        ];
        // Mean of exp(−t/T) over the session: what a recording on an unknown clock is given.
        let neutral = time_constant / length * (1.0 - (-length / time_constant).exp());
        terms.extend(warming.map(|term| {
            Term::WarmUp(WarmUp {
                term: Box::new(term),
                time_constant,
                start: clock.start,
                neutral,
            })
        }));
    }
    terms
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_short_session_has_no_warm_up_and_a_slide_no_harmonics() {
        let short = candidates(
            false,
            SessionClock {
                start: 0.0,
                end: 60.0,
            },
        );
        assert!(
            !short
                .iter()
                .any(|t| matches!(t, Term::WarmUp(_) | Term::Harmonic(_) | Term::Position(_)))
        );
        let long = candidates(
            true,
            SessionClock {
                start: 10.0,
                end: 4000.0,
            },
        );
        assert!(long.iter().any(|t| matches!(t, Term::WarmUp(w) if w.time_constant == 3600.0 && w.neutral > 0.3 && w.neutral < 0.7)));
    }
}
