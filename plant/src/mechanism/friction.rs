//! Friction at the gear's surfaces beyond viscous + Coulomb: boundary lubrication, fluids that are not
//! Newtonian.

use super::{Instant, Mechanism, soft_sign};

/// Law by which the extra friction of a starting joint falls with speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum StribeckKind {
    /// Lorentz curve: 1/(1 + (v/v_s)²).
    Lorentz,
    /// Half cosine: (1 + cos(π v/v_s))/2 up to v_s, nothing above.
    HalfCosine,
    /// Lubricant film: exp(−h), a film of relative height h that builds up and drains with this time constant, s,
    /// towards |v|/v_s.
    Film(f64),
}

/// Boundary friction of a joint that starts to slide.
#[derive(Debug, Clone)]
pub struct Stribeck {
    /// Index of the plant's joint on which the mechanism acts.
    pub joint: usize,
    /// Extra friction at standstill, N·m.
    pub size: f64,
    /// Speed at which the extra friction has mostly gone, rad/s.
    pub v_s: f64,
    /// Speed over which the sign of velocity is softened, rad/s.
    pub v_eps: f64,
    /// Law of the fall with speed.
    pub kind: StribeckKind,
    /// Thickness of the lubricant film relative to that at v_s.
    pub film: f64,
}

impl Mechanism for Stribeck {
    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn resist(&self, _now: &Instant, v: f64) -> f64 {
        let x = v.abs() / self.v_s;
        let shape = match self.kind {
            StribeckKind::Lorentz => 1.0 / (1.0 + x * x),
            StribeckKind::HalfCosine if x < 1.0 => 0.5 + 0.5 * (std::f64::consts::PI * x).cos(),
            StribeckKind::HalfCosine => 0.0,
            StribeckKind::Film(_) => (-self.film).exp(),
        };
        self.size * shape * soft_sign(v, self.v_eps)
    }

    fn advance(&mut self, now: &Instant, v: &[f64]) {
        if let StribeckKind::Film(time) = self.kind {
            let target = v[self.joint].abs() / self.v_s;
            self.film += (target - self.film) * (now.dt / (now.dt + time));
        }
    }
}

/// Fluid friction that is not proportional to speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DragKind {
    /// Activated flow (Eyring): asinh(v/v₀)/asinh(1/v₀·v_top), 1 at top speed.
    Eyring,
    /// Churning oil: (|v|/v_top)^1.8 sign v.
    Churning,
    /// Deficit of a shear-thinning grease (Carreau) against a Newtonian one: ((1 + (v/v₀)²)^−0.35 − 1)·v/v_top.
    Carreau,
    /// Power law: (|v|/v_top)^α sign v.
    Power(f64),
}

/// Nonlinear fluid friction of one joint, on top of its viscous friction.
#[derive(Debug, Clone)]
pub struct Drag {
    /// Index of the plant's joint on which the mechanism acts.
    pub joint: usize,
    /// Scale of the drag's torque, N·m.
    pub size: f64,
    /// Velocity up to which the fluid is Newtonian, rad/s.
    pub v_0: f64,
    /// Top speed of the joint, rad/s.
    pub v_top: f64,
    /// Law of the drag over speed.
    pub kind: DragKind,
}

impl Mechanism for Drag {
    fn joint(&self) -> Option<usize> {
        Some(self.joint)
    }

    fn resist(&self, _now: &Instant, v: f64) -> f64 {
        let x = v / self.v_top;
        let y = v / self.v_0;
        self.size
            * match self.kind {
                DragKind::Eyring => y.asinh() / (self.v_top / self.v_0).asinh(),
                DragKind::Churning => x * x.abs().powf(0.8),
                DragKind::Power(alpha) => x.abs().powf(alpha) * v.signum(),
                DragKind::Carreau => x * ((1.0 + y * y).powf(-0.35) - 1.0),
            }
    }
}
