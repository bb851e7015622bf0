//! Part of a held-out motion outside the fitted motion.

use datasets::prepare::Prepared;
use ndarray::Array2;
use physics::robot::Robot;
use signal::Motion;
use signal::quantile::quantile;

/// Part of the samples that lie beyond the fitted range as a matter of course: its ends are quantiles with that part
/// outside.
const ENDS: f64 = 0.005;
/// Factor on the fitted range up to which shapes of friction may be extrapolated.
const FARTHER: f64 = 1.25;
/// Part of the held-out samples farther out from which the motion is another one.
const BEYOND: f64 = 0.05;

/// A joint whose held-out motion lies outside the fitted motion.
pub struct Outside {
    /// Index of the joint, base first.
    pub joint: usize,
    /// Name of the joint outside its fitted motion.
    pub name: String,
    /// Part of the held-out samples that are beyond the fitted speeds or accelerations.
    pub part: f64,
    /// Whether the joint leaves the fitted speeds. Friction follows the speed, so that its shapes are extrapolated then;
    /// accelerations belong to the rigid body.
    pub faster: bool,
    /// Ratio of the largest held-out to the largest fitted speed, and of the accelerations.
    pub times: [f64; 2],
}

impl Outside {
    /// Text for the user, one line.
    pub fn line(&self) -> String {
        format!(
            "{}: {:.0} % of the held-out motion lie outside what was taught (top speed {:.1} times, acceleration {:.1} times): figures there are \
             extrapolated{}",
            self.name,
            100.0 * self.part,
            self.times[0],
            self.times[1],
            if self.faster {
                ", and the joint keeps simple friction"
            } else {
                ""
            }
        )
    }
}

/// Joints whose held-out motion goes beyond the speeds or accelerations of the fitted one.
pub fn outside(robot: &Robot, fitted: &[Prepared], heldout: &Prepared) -> Vec<Outside> {
    let top = |of: fn(&Motion) -> &Array2<f64>, j: usize| {
        let all = fitted
            .iter()
            .flat_map(|p| of(&p.at_samples).column(j).to_vec());
        quantile(all.map(f64::abs).collect(), 1.0 - ENDS).unwrap_or(0.0)
    };
    let one = |joint: usize| {
        let limits = [top(|m| &m.qd, joint), top(|m| &m.qdd, joint)];
        let own = &heldout.at_samples;
        let tables = [&own.qd, &own.qdd];
        let rows = own.len();
        let farther = |r: usize, k: usize| tables[k][(r, joint)].abs() > FARTHER * limits[k];
        let part_of = |is_beyond: &dyn Fn(usize) -> bool| {
            (0..rows).filter(|&r| is_beyond(r)).count() as f64 / rows.max(1) as f64
        };
        let times = [0, 1].map(|k| {
            let sizes = tables[k].column(joint).iter().map(|v| v.abs()).collect();
            quantile(sizes, 1.0 - ENDS).unwrap_or(0.0) / limits[k].max(f64::MIN_POSITIVE)
        });
        let part = part_of(&|r| (0..2).any(|k| farther(r, k)));
        (part > BEYOND && limits[0] > 0.0).then(|| Outside {
            joint,
            name: robot.joints()[joint].name.clone(),
            part,
            faster: part_of(&|r| farther(r, 0)) > BEYOND,
            times,
        })
    };
    (0..robot.dof()).filter_map(one).collect()
}
