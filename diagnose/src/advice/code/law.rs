//! Terms of the torque model as lines of Python that NumPy and PyTorch read alike.
//!
//! Torque that reverses with a joint's motion is no torque of the law but a *level*: the size of the friction
//! that holds the joint. The simulator's own friction turns it against the motion without chatter. All other
//! terms are torques.

use physics::effects::{Coupling, FrictionShape, Harmonic, Phase, Sliding, Term};

/// A term for a simulator, with its joint, effect and size.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    /// Index of the joint, base first.
    pub(super) joint: usize,
    /// Name of the effect that the term is of, as in the report.
    pub(super) effect: &'static str,
    /// Coefficient: torque is `size` times the term's column.
    pub(super) size: f64,
    /// Term with its shape parameters.
    pub(super) term: Term,
}

/// Body of the function `law`, and its requirements.
#[derive(Clone, Debug, Default)]
pub(super) struct Law {
    /// Joints that the law reads or loads, by index of the arm; their order is that of the law's last axis.
    pub(super) joints: Vec<usize>,
    /// Lines of Python that are the function's body.
    pub(super) lines: Vec<String>,
    /// Number of states that the function carries from one call to the next.
    pub(super) memory: usize,
    /// Functions that the lines call, as source.
    pub(super) helpers: Vec<&'static str>,
    /// Names that the lines need of NumPy or PyTorch.
    pub(super) imports: Vec<&'static str>,
    /// Whether the lines read the load of the transmissions or the acceleration.
    pub(super) sees: Sees,
}

/// Quantities that a simulator computes only for the law.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Sees {
    pub(super) load: bool,
    pub(super) acceleration: bool,
}

const DAHL: &str = "\
def dahl(z, dq, stiffness):
    \"\"\"Dahl's friction state in [-1, 1] after a displacement dq.\"\"\"
    end = sign(dq)
    return end + (z - end) * exp(-stiffness * abs(dq))
";
const STOP: &str = "\
def stop(z, dq, width):
    \"\"\"State in [-1, 1] of a spring that slides from `width` on (Maxwell slip), after a displacement dq.\"\"\"
    return clip(z + dq / width, -1.0, 1.0)
";
const LAGGED: &str = "\
def lagged_sign(z, qd, dt, constant, standstill):
    \"\"\"Direction of motion behind a lag of `constant` seconds; kept at rest.\"\"\"
    moving = 1.0 * (abs(qd) > standstill)
    end = sign(qd)
    return z + moving * (end - z) * (1.0 - math.exp(-dt / constant))
";
const LEGENDRE: &str = "\
def legendre(degree, q, middle, half):
    \"\"\"Legendre polynomial over the recorded range, held beyond 1.2 half ranges.\"\"\"
    x = clip((q - middle) / half, -1.2, 1.2)
    last, p = 0.0 * x + 1.0, x
    if degree == 0:
        return last
    for n in range(1, degree):
        last, p = p, ((2 * n + 1) * x * p - n * last) / (n + 1)
    return p
";
const WARM_UP: &str = "\
def warm_up(clock, start, constant, neutral):
    \"\"\"1 at the session's start, falling; `neutral` where the clock is unknown.\"\"\"
    return neutral if clock is None else math.exp(-max(clock - start, 0.0) / constant)
";
const DRIFT: &str = "\
def drift(clock, start, span, neutral):
    \"\"\"0 at the session's start, 1 at its end; `neutral` where the clock is unknown.\"\"\"
    return neutral if clock is None else min(max((clock - start) / span, -1.0), 2.0)
";

impl Law {
    /// Law of some terms; `softness` is the velocity of softening of friction, rad/s (m/s), by joint of the arm.
    pub(super) fn new(pieces: &[Piece], softness: &[f64], names: &[String]) -> Self {
        let mut joints: Vec<usize> = pieces
            .iter()
            .flat_map(|p| std::iter::once(p.joint).chain(p.term.driver()))
            .collect();
        joints.sort_unstable();
        joints.dedup();
        let mut own = Self {
            joints,
            ..Self::default()
        };
        let mut last = None;
        for piece in pieces {
            if last != Some((piece.joint, piece.effect)) {
                let line = format!("# {}: {}", comment(&names[piece.joint]), piece.effect);
                own.lines.push(line);
                last = Some((piece.joint, piece.effect));
            }
            let at = own.at(piece.joint);
            if let Some(value) = own.level(&piece.term, piece.joint, softness[piece.joint]) {
                own.add("level", at, piece.size, &value);
            } else {
                let value = own.torque(&piece.term, piece.joint);
                own.add("torque", at, piece.size, &value);
            }
        }
        own
    }

    /// Index of a joint of the arm on the law's last axis.
    fn at(&self, joint: usize) -> usize {
        let found = self.joints.iter().position(|j| *j == joint);
        found.expect("every joint of a piece is in the list")
    }

    fn of(&self, what: &str, joint: usize) -> String {
        format!("{what}[..., {}]", self.at(joint))
    }

    fn add(&mut self, onto: &str, at: usize, size: f64, value: &str) {
        let line = match value {
            "1.0" => format!("{onto}[..., {at}] += {size:?}"),
            value => format!("{onto}[..., {at}] += {size:?} * {value}"),
        };
        self.lines.push(line);
    }

    fn needs(&mut self, helper: &'static str, names: &[&'static str]) {
        if !self.helpers.contains(&helper) {
            self.helpers.push(helper);
        }
        self.import(names);
    }

    fn import(&mut self, names: &[&'static str]) {
        self.imports.extend(names);
        self.imports.sort_unstable();
        self.imports.dedup();
    }

    /// Level of a term that reverses with its own joint's motion; none for other terms.
    fn level(&mut self, term: &Term, joint: usize, softness: f64) -> Option<String> {
        let qd = self.of("qd", joint);
        match term {
            Term::Sliding(s) => self.sliding_level(s, &qd, softness),
            Term::EarlySign(_) => Some("1.0".into()),
            Term::Load(l) => {
                let FrictionShape::Sliding(s) = l.friction else {
                    return None;
                };
                let level = self.sliding_level(&s, &qd, softness)?;
                Some(times(&self.load(joint, l.exponent), &level))
            }
            Term::Position(p) => {
                let FrictionShape::Sliding(s) = p.friction else {
                    return None;
                };
                let level = self.sliding_level(&s, &qd, softness)?;
                Some(times(&self.harmonic(p.harmonic, joint), &level))
            }
            Term::WarmUp(w) => {
                let level = self.level(&w.term, joint, softness)?;
                Some(times(&self.warm_up(w), &level))
            }
            Term::Drift(d) => {
                let level = self.level(&d.term, joint, softness)?;
                Some(times(&self.drift(d), &level))
            }
            _ => None,
        }
    }

    /// Level of friction that depends on the present speed, where it jumps at a reversal; none for other shapes.
    fn sliding_level(&mut self, s: &Sliding, qd: &str, softness: f64) -> Option<String> {
        Some(match *s {
            Sliding::Coulomb => "1.0".into(),
            Sliding::SoftCoulomb { velocity } if velocity <= softness => "1.0".into(),
            Sliding::SoftCoulomb { velocity } => {
                self.import(&["tanh"]);
                format!("abs(tanh({qd} / {velocity:?}))")
            }
            Sliding::AsymmetricCoulomb { velocity } => {
                self.import(&["tanh"]);
                format!("tanh({qd} / {velocity:?})")
            }
            Sliding::Stribeck { velocity } => {
                self.import(&["exp"]);
                format!("exp(-abs({qd}) / {velocity:?})")
            }
            Sliding::SoftStribeck {
                velocity, exponent, ..
            } => {
                self.import(&["exp"]);
                format!("exp(-(abs({qd}) / {velocity:?}) ** {exponent:?})")
            }
            Sliding::Viscous
            | Sliding::AsymmetricViscous
            | Sliding::Degressive { .. }
            | Sliding::Power { .. } => return None,
        })
    }

    /// Torque of a term with coefficient one.
    fn torque(&mut self, term: &Term, joint: usize) -> String {
        let (q, qd) = (self.of("q", joint), self.of("qd", joint));
        let dq = self.of("dq", joint);
        match term {
            Term::Offset => "1.0".into(),
            Term::RotorInertia => self.acceleration(joint),
            Term::Sliding(s) => self.sliding(s, &qd),
            Term::EarlySign(e) => {
                self.import(&["tanh"]);
                let qdd = self.acceleration(joint);
                format!("tanh(({qd} + {:?} * {qdd}) / {:?})", e.lead, e.velocity)
            }
            Term::Stop(s) => {
                self.needs(STOP, &["clip"]);
                self.state(|z| format!("stop({z}, {dq}, {:?})", s.width))
            }
            Term::Dahl(d) => self.dahl(d.stiffness, &dq),
            Term::DahlRate(d) => {
                let z = self.dahl(d.stiffness, &dq);
                format!("({z} - {}) / dt", z.replace("z[", "before["))
            }
            Term::LaggedSign(l) => {
                self.needs(LAGGED, &["sign"]);
                let (constant, rest) = (l.time_constant, l.standstill);
                self.state(|z| format!("lagged_sign({z}, {qd}, dt, {constant:?}, {rest:?})"))
            }
            Term::Load(l) => {
                let shape = self.shape(&l.friction, &qd, &dq);
                times(&self.load(joint, l.exponent), &shape)
            }
            Term::Position(p) => {
                let shape = self.shape(&p.friction, &qd, &dq);
                times(&self.harmonic(p.harmonic, joint), &shape)
            }
            Term::Polynomial(p) => {
                self.needs(LEGENDRE, &["clip"]);
                format!("legendre({}, {q}, {:?}, {:?})", p.degree, p.middle, p.half)
            }
            Term::Harmonic(h) => self.harmonic(*h, joint),
            Term::Coupling(c) => self.coupling(c, joint),
            Term::Counterbalance(_) | Term::Spring(_) => {
                unreachable!("given by the description, never found")
            }
            Term::WarmUp(w) => {
                let torque = self.torque(&w.term, joint);
                times(&self.warm_up(w), &torque)
            }
            Term::Drift(d) => {
                let torque = self.torque(&d.term, joint);
                times(&self.drift(d), &torque)
            }
        }
    }

    fn sliding(&mut self, s: &Sliding, qd: &str) -> String {
        match *s {
            Sliding::Viscous => qd.to_owned(),
            Sliding::AsymmetricViscous => format!("abs({qd})"),
            Sliding::Coulomb => {
                self.import(&["sign"]);
                format!("sign({qd})")
            }
            Sliding::SoftCoulomb { velocity } | Sliding::Degressive { velocity } => {
                self.import(&["tanh"]);
                format!("tanh({qd} / {velocity:?})")
            }
            Sliding::AsymmetricCoulomb { velocity } => {
                self.import(&["tanh"]);
                format!("tanh({qd} / {velocity:?}) ** 2")
            }
            Sliding::Stribeck { velocity } => {
                self.import(&["exp", "sign"]);
                format!("sign({qd}) * exp(-abs({qd}) / {velocity:?})")
            }
            Sliding::SoftStribeck {
                velocity,
                exponent,
                softness,
            } => {
                self.import(&["exp", "tanh"]);
                let fall = format!("exp(-(abs({qd}) / {velocity:?}) ** {exponent:?})");
                format!("tanh({qd} / {softness:?}) * {fall}")
            }
            Sliding::Power { exponent } => {
                self.import(&["sign"]);
                format!("sign({qd}) * abs({qd}) ** {exponent:?}")
            }
        }
    }

    fn shape(&mut self, shape: &FrictionShape, qd: &str, dq: &str) -> String {
        match shape {
            FrictionShape::Sliding(s) => self.sliding(s, qd),
            FrictionShape::Dahl(d) => self.dahl(d.stiffness, dq),
        }
    }

    fn coupling(&mut self, coupling: &Coupling, joint: usize) -> String {
        match *coupling {
            Coupling::Friction { driver, shape } => {
                let qd = self.of("qd", driver);
                self.sliding(&shape, &qd)
            }
            Coupling::Inertia { driver } => self.acceleration(driver),
            Coupling::Spring { driver, middle } => {
                format!("({} - {middle:?})", self.of("q", driver))
            }
            Coupling::Relative {
                driver,
                ratio,
                velocity,
            } => {
                self.import(&["tanh"]);
                let (own, other) = (self.of("qd", joint), self.of("qd", driver));
                format!("tanh(({own} + {ratio:?} * {other}) / {velocity:?})")
            }
        }
    }

    fn acceleration(&mut self, joint: usize) -> String {
        self.sees.acceleration = true;
        self.of("qdd", joint)
    }

    fn load(&mut self, joint: usize, exponent: f64) -> String {
        self.sees.load = true;
        let load = self.of("load", joint);
        if exponent == 1.0 {
            format!("abs({load})")
        } else {
            format!("abs({load}) ** {exponent:?}")
        }
    }

    fn harmonic(&mut self, h: Harmonic, joint: usize) -> String {
        let (name, q) = (
            match h.phase {
                Phase::Sin => "sin",
                Phase::Cos => "cos",
            },
            self.of("q", joint),
        );
        self.import(&[name]);
        format!("{name}({:?} * {q})", h.order)
    }

    fn warm_up(&mut self, w: &physics::effects::WarmUp) -> String {
        self.needs(WARM_UP, &[]);
        let (start, constant, neutral) = (w.start, w.time_constant, w.neutral);
        format!("warm_up(clock, {start:?}, {constant:?}, {neutral:?})")
    }

    fn drift(&mut self, d: &physics::effects::Drift) -> String {
        self.needs(DRIFT, &[]);
        let (start, span, neutral) = (d.start, d.span, d.neutral);
        format!("drift(clock, {start:?}, {span:?}, {neutral:?})")
    }

    fn dahl(&mut self, stiffness: f64, dq: &str) -> String {
        self.needs(DAHL, &["exp", "sign"]);
        self.state(|z| format!("dahl({z}, {dq}, {stiffness:?})"))
    }

    /// Allocates a state, advances it by `next`, and returns its name.
    fn state(&mut self, next: impl Fn(&str) -> String) -> String {
        let z = format!("z[..., {}]", self.memory);
        self.memory += 1;
        self.lines.push(format!("{z} = {}", next(&z)));
        z
    }
}

fn times(factor: &str, value: &str) -> String {
    match value {
        "1.0" => factor.to_owned(),
        value => format!("{factor} * {value}"),
    }
}

/// Text that stays on one line of a comment or docstring.
pub(super) fn comment(text: &str) -> String {
    let plain = |c: char| {
        if c.is_control() || c == '\\' || c == '"' {
            ' '
        } else {
            c
        }
    };
    text.chars().map(plain).collect()
}
