//! Decision whether the torque or the description has the wrong size.
//!
//! A change that all joints share may be another unit of the torque, or other masses of the description. Three kinds of
//! evidence tell them apart, each as log-odds. A unit scales described friction, and a mass does not. A link's mass
//! acts on all joints before it, and a joint's unit on that joint alone. Descriptions and units are usually wrong by
//! different amounts. A description that does not even fit in shape decides nothing. Where the evidence is not enough,
//! both are reported, without a line for the drive file.

use super::blocks::Blocks;
use super::patient::{Patient, complaint, short};
use super::shared::{Shared, positive, reduce, shared, solved};
use crate::preparation::channel::systems::{Joint, Systems};
use datasets::channel::ChannelEstimate;
use datasets::check::{Ailment, Complaint, Severity};
use datasets::prepare::Prepared;
use nalgebra::{DMatrix, DVector};
use physics::robot::{PARAMETERS_PER_LINK, Robot};
use signal::delay::{Search, System, rows_at};
use signal::quantile::median;

/// Part of a torque's variance below which a squared error tells nothing: described torques are right to about a tenth
/// of their deviation.
pub(super) const LEAST: f64 = 0.01;
/// Factor by which described friction is usually wrong.
const FRICTION: f64 = 1.5;
/// Factor by which wrong described masses are usually wrong.
pub(super) const MASSES: f64 = 1.6;
/// Number of standard deviations above zero from which a factor counts as known.
const KNOWN: f64 = 2.0;
/// Log-odds from which a decision is made: one in twenty of them is wrong.
pub(super) const DECIDES: f64 = 3.0;
/// Largest log-odds that one kind of evidence can have. The model behind it is wrong, so that none is beyond doubt.
pub(super) const MOST: f64 = 6.0;
/// Mean misfit over the joints, see [`Table::misfit`], from which the description does not fit in shape.
const ANOTHER: f64 = 1.1;

/// Complaints in place of one about the size of the torque: that one, one about the description, or both. Other
/// complaints are returned unchanged.
pub(super) fn weighed(
    found: Complaint,
    patient: &Patient,
    prepared: &Prepared,
    channel: &ChannelEstimate,
) -> Vec<Complaint> {
    if !is_of_size(found.ailment) {
        return vec![found];
    }
    if let Some(why) = placeholder(patient.robot) {
        return vec![of_placeholder(patient, why)];
    }
    let Some(odds) = Odds::of(patient, prepared, channel, &found.joints) else {
        return vec![found];
    };
    let total = odds.total();
    if total > DECIDES {
        return vec![found];
    }
    let description = odds.said(patient, &found, total < -DECIDES);
    if total < -DECIDES {
        return vec![description];
    }
    vec![undecided(found), description]
}

/// Adds a complaint about the description where that on the torque's size stands alone and the weight shows without the
/// inertia. Two faults of the channel are no likelier than one description of another robot.
pub(super) fn doubted(found: Vec<Complaint>, patient: &Patient) -> Vec<Complaint> {
    let alone = !found.iter().any(|c| c.ailment == Ailment::Description);
    let Some(at) = found.iter().position(|c| alone && is_of_size(c.ailment)) else {
        return found;
    };
    let mut found = found;
    let of_size = undecided(found.remove(at));
    let description = complaint(
        Ailment::Description,
        Severity::Severe,
        patient.all(),
        [
            "neither the size of the torque nor how its inertia goes with its weight is as described".to_owned(),
            "a description of another robot, or a torque with two faults".to_owned(),
            "check that description and recording are of one robot; keep the torque as it is until you know".to_owned(),
        ],
    );
    found.extend([of_size, description]);
    found
}

/// Whether a complaint is about the size of the torque.
fn is_of_size(ailment: Ailment) -> bool {
    use Ailment::{Current, Motor, PerMille, Percent, Scale};
    matches!(ailment, Current | Motor | PerMille | Percent | Scale)
}

/// Complaint about the size of the torque beside one about the description: without lines for the drive file.
fn undecided(found: Complaint) -> Complaint {
    Complaint {
        drive: None,
        means: format!(
            "{}, or a description that is wrong: this recording does not tell which",
            found.means
        ),
        advice: "look up what the column holds; weigh a link, or lift a known mass: a unit scales it, a description does not"
            .to_owned(),
        ..found
    }
}

/// Reason why the masses are placeholders that nobody measured; none where they are not.
pub(super) fn placeholder(robot: &Robot) -> Option<String> {
    let bodies: Vec<_> = robot.joints().iter().map(|j| &j.link.inertia).collect();
    let first = bodies.first()?;
    let alike = |a: f64, b: f64| (a - b).abs() <= 1e-6 * a.abs().max(b.abs());
    let masses = bodies.iter().all(|b| alike(b.mass, first.mass));
    (bodies.len() > 1 && masses && first.mass > 0.0).then(|| {
        format!(
            "every link of the description weighs {} kg",
            short(first.mass)
        )
    })
}

/// Complaint about a description whose masses are placeholders, for the reason `why`.
fn of_placeholder(patient: &Patient, why: String) -> Complaint {
    complaint(
        Ailment::Description,
        Severity::Severe,
        patient.all(),
        [
            why,
            "a description whose masses are placeholders: it says nothing of the torque's unit, nor of a load".to_owned(),
            "identify the masses (train), if the torque is in N·m; nothing here can tell whether it is".to_owned(),
        ],
    )
}

/// Log-odds of another unit over wrong masses of the description, and what the masses would be.
struct Odds {
    /// Log-odds by friction; none where no described friction is known well enough.
    friction: Option<f64>,
    /// Log-odds by the shape over the joints.
    shape: f64,
    /// Log-odds by the usual size of errors of a description.
    usual: f64,
    /// Whether the described torque fits in shape, whatever its size.
    fits: bool,
    /// Common factor of all masses that explains the torque; none where separate factors of the links explain it
    /// better.
    factor: Option<f64>,
    /// Factor of each link's mass that explains the torque; none where the torque hardly depends on it.
    masses: Vec<Option<f64>>,
    /// Whether a load at the last link explains the torque better than other masses.
    load: bool,
}

impl Odds {
    /// Log-odds for a recording. `joints` are those whose scale is unusual.
    fn of(
        patient: &Patient,
        prepared: &Prepared,
        channel: &ChannelEstimate,
        joints: &[usize],
    ) -> Option<Self> {
        let tables = tables(patient, prepared, channel)?;
        let scales: Vec<f64> = tables.iter().map(Table::scale).collect();
        let unit = mean(tables.iter().map(|t| t.misfit(t.left_by_scale(joints))));
        let masses = of_all(&tables, positive, |t| (&t.whole, t.links()));
        let by_masses = mean(tables.iter().zip(&masses.left).map(|(t, l)| t.misfit(*l)));
        let one = of_all(&tables, positive, |t| (&t.whole, vec![t.rigid()]));
        let by_one = mean(tables.iter().zip(&one.left).map(|(t, l)| t.misfit(*l)));
        let load = of_all(&tables, solved, |t| (&t.rest, t.last()));
        let by_load = mean(tables.iter().zip(&load.left).map(|(t, l)| t.misfit(*l)));
        // A load cannot weigh less than nothing.
        let heavy = load.values.first().is_some_and(|m| *m > 0.0);
        let description = match heavy {
            true => by_masses.min(by_load),
            false => by_masses,
        };
        let count = tables.len() as f64;
        let sizes = scales.iter().filter(|s| **s > 0.0).map(|s| s.ln().abs());
        let size = median(sizes.collect()).unwrap_or(0.0);
        Some(Self {
            friction: friction(&tables, &scales),
            shape: (0.5 * count * (description - unit)).clamp(-MOST, MOST),
            usual: (0.5 * (size / MASSES.ln()).powi(2) - 2.0).clamp(-MOST, MOST),
            fits: unit < ANOTHER,
            load: heavy && by_load < by_masses,
            factor: (0.5 * count * (by_one - by_masses) < DECIDES)
                .then(|| one.values.first().copied())
                .flatten(),
            masses: masses
                .values
                .iter()
                .zip(&masses.deviations)
                .map(|(value, std)| (*value > KNOWN * std).then_some(*value))
                .collect(),
        })
    }

    /// Sum of the log-odds. It is not above zero where the description does not fit in shape.
    fn total(&self) -> f64 {
        let sum = self.friction.unwrap_or(0.0) + self.shape + self.usual;
        if self.fits { sum } else { sum.min(0.0) }
    }

    /// Complaint about the description. `alone`: whether it replaces the complaint `found`.
    fn said(&self, patient: &Patient, found: &Complaint, alone: bool) -> Complaint {
        let each: Vec<String> = patient
            .robot
            .joints()
            .iter()
            .zip(&self.masses)
            .filter_map(|(joint, m)| Some(format!("{} {}", joint.link.name, short((*m)?))))
            .collect();
        let factors = match self.factor {
            Some(factor) => format!("masses times {}", short(factor)),
            None if each.is_empty() => "other masses".to_owned(),
            None => format!("masses times {}", each.join(", ")),
        };
        let friction = match self.friction {
            Some(odds) if odds < -1.0 => "; the friction is the described one",
            Some(odds) if odds > 1.0 => "; the friction is off as well",
            Some(_) => "; the friction decides nothing",
            None => "; the description has no friction, which would tell",
        };
        let means = match (self.fits, self.load) {
            (_, true) => {
                "a load at the last link that the description lacks, or masses that are wrong: a torque's unit changes them alike"
            }
            (true, false) => {
                "a description whose masses are wrong: a torque's unit changes them alike"
            }
            (false, false) => {
                "a description that does not fit in shape either: its masses are wrong, or it is another robot's"
            }
        };
        let end = if alone {
            "keep the torque as it is; train and diagnose find the masses"
        } else {
            "keep the torque as it is until you know: a factor that is wrong spoils all that is fitted"
        };
        complaint(
            Ailment::Description,
            Severity::Severe,
            found.joints.clone(),
            [
                format!("{factors} explain the torque{friction}"),
                means.to_owned(),
                end.to_owned(),
            ],
        )
    }
}

/// Tables of all joints that can be compared.
fn tables(patient: &Patient, prepared: &Prepared, channel: &ChannelEstimate) -> Option<Vec<Table>> {
    let systems = Systems::new(patient.robot, patient.recording, prepared)?;
    let delay = channel.delay.value.unwrap_or(0.0);
    let parameters = patient.robot.parameters();
    let tables = systems
        .joints
        .iter()
        .enumerate()
        .filter_map(|(j, joint)| {
            Table::new(
                patient.robot,
                &systems,
                joint.as_ref()?,
                j,
                delay,
                &parameters,
            )
        })
        .collect();
    Some(tables)
}

/// Log-odds of another unit by the ratio of recorded to described friction, given the joints' scales; none where no
/// ratio is known.
fn friction(tables: &[Table], scales: &[f64]) -> Option<f64> {
    let known: Vec<f64> = tables
        .iter()
        .zip(scales)
        .filter(|(_, scale)| **scale > 0.0)
        .filter_map(|(table, scale)| {
            let friction = table.friction_scale()?;
            let square = |ln: f64| (ln / FRICTION.ln()).powi(2).min(2.0 * MOST);
            Some(0.5 * (square(friction.ln()) - square(friction.ln() - scale.ln())))
        })
        .collect();
    (!known.is_empty()).then(|| known.iter().sum::<f64>().clamp(-MOST, MOST))
}

/// Products of one joint's columns with its torque. The columns are the links' described torques, the last link's
/// standard parameters, the whole described torque, rotor, offset and friction, and described friction.
struct Table {
    /// Products with the recorded torque as target.
    whole: Blocks,
    /// Products with the recorded less the described torque as target.
    rest: Blocks,
    /// Index of the joint.
    joint: usize,
    /// Number of joints.
    dof: usize,
    /// Number of columns of offset and friction.
    frictions: usize,
    /// Whether the description has friction for the joint.
    described_friction: bool,
    /// Squared error below which differences tell nothing.
    floor: f64,
}

impl Table {
    /// Table of one joint with the torque moved by `delay`, s.
    fn new(
        robot: &Robot,
        systems: &Systems,
        joint: &Joint,
        index: usize,
        delay: f64,
        parameters: &[f64],
    ) -> Option<Self> {
        let n = robot.dof();
        let rows = joint.torque.len();
        let filled = |c: &Vec<f64>| {
            if c.is_empty() {
                vec![0.0; rows]
            } else {
                c.clone()
            }
        };
        let of_link = |l: usize| {
            let at = l * PARAMETERS_PER_LINK;
            let mut sum = vec![0.0; rows];
            let own = joint.standard.iter().zip(parameters.iter());
            for (column, p) in own.skip(at).take(PARAMETERS_PER_LINK) {
                sum.iter_mut().zip(column).for_each(|(s, v)| *s += p * v);
            }
            sum
        };
        let mut columns: Vec<Vec<f64>> = (0..n).map(of_link).collect();
        columns.extend(
            joint.standard[(n - 1) * PARAMETERS_PER_LINK..]
                .iter()
                .map(filled),
        );
        columns.push(joint.rigid.clone());
        columns.push(joint.rotor.clone());
        columns.extend(joint.friction.iter().cloned());
        let own = &robot.joints()[index];
        let described = joint.friction[1]
            .iter()
            .zip(&joint.friction[2])
            .map(|(v, s)| own.damping * v + own.friction * s);
        columns.push(described.collect());
        let width = columns.len();
        let system = System {
            columns,
            target: joint.torque.clone(),
            segments: systems.segments.clone(),
            steps: systems.steps.clone(),
        };
        let (values, target) = rows_at(&system, delay, &Search::default())?;
        let rigid = n + PARAMETERS_PER_LINK;
        let rest: Vec<f64> = target
            .iter()
            .zip(values.chunks(width))
            .map(|(t, line)| t - line[rigid])
            .collect();
        let mut table = Self {
            whole: Blocks::new(&values, &target, width),
            rest: Blocks::new(&values, &rest, width),
            joint: index,
            dof: n,
            frictions: joint.friction.len(),
            described_friction: own.damping > 0.0 || own.friction > 0.0,
            floor: 0.0,
        };
        let system = systems.system(joint, index);
        let free = {
            let width = system.columns.len();
            let (values, target) = rows_at(&system, delay, &Search::default())?;
            Blocks::new(&values, &target, width).left(&(0..width).collect::<Vec<_>>())
        };
        table.floor = free + LEAST * table.whole.left(&[table.rigid() + 2]);
        Some(table)
    }

    /// Indices of the columns of the links' described torques.
    fn links(&self) -> Vec<usize> {
        (0..self.dof).collect()
    }

    /// Indices of the columns of the last link's standard parameters.
    fn last(&self) -> Vec<usize> {
        (self.dof..self.dof + PARAMETERS_PER_LINK).collect()
    }

    /// Index of the column of the whole described torque.
    fn rigid(&self) -> usize {
        self.dof + PARAMETERS_PER_LINK
    }

    /// Indices of the columns of rotor, offset and friction, which are free in every explanation.
    fn own(&self) -> Vec<usize> {
        let first = self.rigid() + 1;
        (first..first + 1 + self.frictions).collect()
    }

    /// Indices of the columns of a fit by one scale: the described torque and the joint's own.
    fn with_scale(&self) -> Vec<usize> {
        let mut columns = vec![self.rigid()];
        columns.extend(self.own());
        columns
    }

    /// Ratio of recorded to described torque, with rotor and friction fitted beside it.
    fn scale(&self) -> f64 {
        self.whole.coefficients(&self.with_scale())[0]
    }

    /// Squared error of the joint: with a free scale where it is among `joints`, else with the described torque as it
    /// is.
    fn left_by_scale(&self, joints: &[usize]) -> f64 {
        if joints.contains(&self.joint) {
            self.whole.left(&self.with_scale())
        } else {
            self.rest.left(&self.own())
        }
    }

    /// Ratio of recorded to described friction; none where none is described or the ratio is not known well enough.
    fn friction_scale(&self) -> Option<f64> {
        let described = self.rigid() + 2 + self.frictions;
        let columns = [self.rigid(), self.rigid() + 1, self.rigid() + 2, described];
        if !self.described_friction {
            return None;
        }
        let found = self.whole.estimate(&columns, |x| x[3]);
        (found.value > KNOWN * found.std).then_some(found.value)
    }

    /// Misfit of a squared error: logarithm of 1 plus its ratio to the floor.
    fn misfit(&self, left: f64) -> f64 {
        (left.max(0.0) / self.floor.max(f64::MIN_POSITIVE) + 1.0).ln()
    }
}

/// Mean of some values.
fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(s, n), v| (s + v, n + 1.0));
    sum / f64::max(count, 1.0)
}

/// Fit of columns whose coefficients all joints share, beside the joints' own columns. `of` names products and columns.
fn of_all<'a>(
    tables: &'a [Table],
    solve: impl Fn(&DMatrix<f64>, &DVector<f64>) -> DVector<f64>,
    of: impl Fn(&'a Table) -> (&'a Blocks, Vec<usize>),
) -> Shared {
    let reduced = tables.iter().map(|table| {
        let (blocks, columns) = of(table);
        let target = table.rigid() + 3 + table.frictions;
        reduce(blocks, &columns, &table.own(), target)
    });
    let floors: Vec<f64> = tables.iter().map(|t| t.floor).collect();
    shared(&reduced.collect::<Vec<_>>(), &floors, solve)
}
