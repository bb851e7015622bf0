//! Hydraulic counterbalance with a gas spring.

/// A cylinder between base and link whose oil is loaded by a gas bladder: a torque that depends on the
/// joint's own position.
///
/// Geometry and gas law of Weigand, Götz, Ulmen and Ruskowski (2022), appendix A.2, eqs 14–18, with
/// δ = q + `zero`:
/// dl = √(D² + k² − 2 D k cos δ) − (D − k), h = D k sin δ / (dl + D − k),
/// p = m Z R T / (V − dl·A), τ = `scale`·h·p·A.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Counterbalance {
    /// Index of the joint on which the counterbalance acts.
    pub joint: usize,
    /// Offset of the joint's zero in the cylinder's geometry, rad (δ = q + zero).
    pub zero: f64,
    /// Distance D from the joint to the attachment on the base, m.
    pub distance: f64,
    /// Radius k of the attachment on the link, m.
    pub radius: f64,
    /// Effective area A of the piston, m².
    pub area: f64,
    /// Largest gas volume V, m³.
    pub volume: f64,
    /// Product m Z R T of gas mass, compressibility, specific gas constant and temperature, J.
    pub gas_energy: f64,
    /// Free factor on the torque, without unit.
    pub scale: f64,
}

impl Counterbalance {
    /// Torque at joint position `q` (rad), N·m, as a part of the torque that the drive has to deliver (it
    /// is added to inverse dynamics).
    pub fn torque(&self, q: f64) -> f64 {
        let (sin, cos) = (q + self.zero).sin_cos();
        let (d, k) = (self.distance, self.radius);
        let length = (d * d + k * k - 2.0 * d * k * cos).sqrt();
        let extension = length - (d - k);
        let lever = d * k * sin / length;
        let pressure = self.gas_energy / (self.volume - extension * self.area);
        self.scale * lever * pressure * self.area
    }
}

#[cfg(test)]
mod tests {
    use super::Counterbalance;
    use crate::dynamics::{Workspace, inverse_dynamics};
    use crate::robot::{Passive, Robot};

    fn known(robot: &Robot) -> Counterbalance {
        match robot.passive() {
            [Passive::Counterbalance(c)] => *c,
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn torque_is_the_derivative_of_the_gas_energy() {
        // A static force law is conservative: τ = dW/dq with W = −E ln(V − dl·A) (isothermal gas).
        let robot = Robot::builtin("kr300").expect("built in");
        let c = known(&robot);
        let work = |q: f64| {
            let (d, k) = (c.distance, c.radius);
            let length = (d * d + k * k - 2.0 * d * k * (q + c.zero).cos()).sqrt();
            -c.gas_energy * (c.volume - (length - (d - k)) * c.area).ln()
        };
        for q in [-0.8, -0.3, 0.0, 0.4, 1.2] {
            let h = 1e-5;
            let slope = (work(q + h) - work(q - h)) / (2.0 * h);
            assert!((c.torque(q) - slope).abs() < 1e-6 * slope.abs(), "{q}");
        }
    }

    /// It holds up the arm: where the arm leans forward it takes the load off the drive.
    #[test]
    fn it_opposes_gravity() {
        let robot = Robot::builtin("kr300").expect("built in");
        let c = known(&robot);
        let mut workspace = Workspace::new(&robot);
        for q2 in [0.2, 0.4, 0.6] {
            let mut tau = [0.0; 6];
            let q = [0.0, q2, 0.0, 0.0, 0.0, 0.0];
            inverse_dynamics(&robot, &mut workspace, &q, &[0.0; 6], &[0.0; 6], &mut tau);
            assert!(
                tau[c.joint] * c.torque(q2) < 0.0,
                "{} {}",
                tau[c.joint],
                c.torque(q2)
            );
            assert!((tau[c.joint] + c.torque(q2)).abs() < tau[c.joint].abs());
        }
    }
}
