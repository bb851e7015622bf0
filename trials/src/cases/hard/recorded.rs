//! Recordings of a hard case, and its answer.

use super::motion::{Day, Role};
use super::robot::Drawn;
use super::truth::{Bias, HardTruth, LowPass, NamedShare};
use super::{TRACE_HZ, channel, robot, sensors};
use crate::SimulateError;
use crate::cases::case::Case;
use crate::cases::experiment::{Experiment, Run, beyond};
use crate::cases::kind::Kind;
use crate::cases::oracle::{Oracle, oracle};
use crate::cases::sensors::warmth;
use crate::cases::size::column_rms;
use crate::cases::truth::Truth;
use crate::cases::witness::{Around, Telling, drawn};
use crate::effects::joint_name;
use datasets::Recording;
use physics::robot::{RobotError, to_urdf};
use plant::arm::Arm;
use plant::measure::record;
use plant::run::Trace;
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::ops::Range;

/// A simulated robot on its way into files.
pub struct Recorded<'a> {
    /// Kind of the case: its withheld effect.
    pub kind: Kind,
    /// Name of the case's files.
    pub id: &'a str,
    /// The described robot and the real one.
    pub drawn: &'a Drawn,
    /// Trajectories of the first day and, where there is one, of the other.
    pub days: &'a [Day],
    /// Experiment of the first day.
    pub experiment: Experiment<'a>,
    /// Role of the file that holds the pushes while the arm stands.
    pub pushed: Role,
    /// Robot around which both were drawn.
    pub nominal: &'a Arm,
    /// Stretches of time in which a standing arm can be pushed, s.
    pub rests: Vec<Range<f64>>,
}

impl Recorded<'_> {
    /// The files and the answer. `first` is the run of the first day, `found` and `background` the torques of effects in it.
    /// None if the robot does not follow its reference on the other day.
    ///
    /// # Errors
    /// The bodies make no possible robot; torques of other sizes than the recording.
    pub fn finish(
        &self,
        mut first: Run,
        found: &[Vec<f64>],
        background: &[Vec<f64>],
        rng: &mut ChaCha8Rng,
    ) -> Result<Option<(Case, Telling)>, SimulateError> {
        let torque_rms = column_rms(&first.noted, first.trace.dof);
        first.trace.warmth = warmth(&first.trace, &self.drawn.plain);
        let channel = channel::draw(&torque_rms, rng);
        let (log, errors) = (sensors::draw(rng), self.experiment.errors);
        let first_log = channel.log(&first.noted, &first.trace.bounds(), rng);
        let day = &self.days[0];
        let rows = day.rows(&first.trace.bounds(), Role::Train);
        let train = log.record(&first.trace, &first_log.recorded, errors, &rows, rng);
        // Another day is another run of the same robot.
        let later = match self.days.get(1) {
            None => None,
            Some(later) => {
                let plain = robot::another_day(&self.drawn.plain, rng);
                let Some(mut run) = self.run_again(&plain, later, ChaCha8Rng::from_rng(rng))?
                else {
                    return Ok(None);
                };
                run.trace.warmth = warmth(&run.trace, &plain);
                let logged = channel.log(&run.noted, &run.trace.bounds(), rng);
                Some((plain, later, run, logged))
            }
        };
        let (plain, day, run, logged) = match &later {
            None => (&self.drawn.plain, day, &first, &first_log),
            Some((plain, day, run, logged)) => (plain, *day, run, logged),
        };
        let rows = day.rows(&run.trace.bounds(), Role::Test);
        let test = log.record(&run.trace, &logged.recorded, errors, &rows, rng);
        let best = self.oracle(plain, run, logged, &rows, rng)?;
        let noise: Vec<f64> = first_log
            .recorded
            .iter()
            .zip(&first_log.clean)
            .map(|(r, c)| r - c)
            .collect();
        let answer = Truth::of(
            self.kind,
            self.id,
            &self.experiment,
            &first,
            found,
            &noise,
            best,
        )?;
        let besides = self.besides(&channel, &log, background, &torque_rms);
        let case = Case {
            id: self.id.to_owned(),
            urdf: to_urdf(&self.drawn.given.robot()?),
            train,
            test,
            truth: Truth {
                hard: Some(besides),
                ..answer
            },
        };
        let telling = Telling {
            nominal: self.nominal.clone(),
            plain: self.drawn.plain.clone(),
            session: self.days[0].session.clone(),
            log: channel.witnessed(first_log, torque_rms, first.trace.bounds(), &log),
            background: background.to_vec(),
            withheld: drawn(self.experiment.withheld),
            around: Around::Widths(self.drawn.inertial_width, self.drawn.friction_width),
            rests: self.rests.clone(),
            trace: first.trace,
        };
        Ok(Some((case, telling)))
    }

    /// Run of the same experiment on another day, with the arm and the session of that day.
    fn run_again(
        &self,
        plain: &Arm,
        day: &Day,
        rng: ChaCha8Rng,
    ) -> Result<Option<Run>, RobotError> {
        Experiment {
            plain,
            session: &day.session,
            ..self.experiment
        }
        .run(rng)
    }

    /// The best that can be had on the held-out rows, sampled evenly: the true plant with all that the channel does but noise.
    fn oracle(
        &self,
        plain: &Arm,
        run: &Run,
        logged: &channel::Logged,
        rows: &[Range<usize>],
        rng: &mut ChaCha8Rng,
    ) -> Result<Oracle, SimulateError> {
        let n = run.trace.dof;
        let cut = |table: &[f64]| -> Vec<f64> {
            let spans = rows.iter().map(|r| &table[r.start * n..r.end * n]);
            spans.flatten().copied().collect()
        };
        let held_out = Trace {
            dof: n,
            time: rows
                .iter()
                .flat_map(|r| run.trace.time[r.clone()].to_vec())
                .collect(),
            lengths: rows.iter().map(Range::len).collect(),
            q: cut(&run.trace.q),
            qd: cut(&run.trace.qd),
            ..Trace::default()
        };
        let (even, _): (Recording, _) = record(
            &held_out,
            &cut(&logged.recorded),
            self.experiment.errors,
            rng,
        );
        let effect = cut(&beyond(plain, &run.trace, &logged.clean)?);
        let noise: Vec<f64> = cut(&logged.recorded)
            .iter()
            .zip(cut(&logged.clean))
            .map(|(r, c)| r - c)
            .collect();
        let vibrates = self.experiment.withheld.iter().any(|w| w.effect.vibrates());
        oracle(
            &self.drawn.given,
            plain,
            &even,
            TRACE_HZ,
            &effect,
            vibrates,
            &noise,
        )
    }

    /// Drawn properties besides robot and effect.
    fn besides(
        &self,
        channel: &channel::Channel,
        log: &sensors::Log,
        background: &[Vec<f64>],
        torque_rms: &[f64],
    ) -> HardTruth {
        let n = torque_rms.len();
        let count = |role: Role| {
            let roles = self.days.iter().flat_map(|d| &d.roles);
            roles.filter(|r| **r == role).count()
        };
        let at_rest = (self.kind == Kind::ContactAtRest).then_some(match self.pushed {
            Role::Train => "train",
            Role::Test => "heldout",
        });
        HardTruth {
            inertial_width: self.drawn.inertial_width,
            friction_width: self.drawn.friction_width,
            no_friction: self
                .drawn
                .no_friction
                .iter()
                .map(|&j| joint_name(j))
                .collect(),
            rest: format!("{:?}", self.drawn.plain.rest).to_lowercase(),
            train: count(Role::Train),
            test: count(Role::Test),
            duration: self.days[0].session.lengths[0],
            rate: log.rate,
            jitter: log.jitter.name(),
            velocity: log.velocity,
            other_day: self.days.len() > 1,
            contact: at_rest,
            lowpass: LowPass {
                same: channel.same,
                lag_ms: channel.lateness().iter().map(|s| 1e3 * s).collect(),
            },
            bias: Bias {
                joint: joint_name(channel.bias.0),
                share: channel.bias.1 / torque_rms[channel.bias.0],
            },
            outliers: channel.outliers,
            background: self
                .experiment
                .background
                .iter()
                .zip(background)
                .map(|(b, torque)| NamedShare {
                    effect: b.name,
                    joint: joint_name(b.at),
                    share: column_rms(torque, n)[b.at] / torque_rms[b.at],
                })
                .collect(),
        }
    }
}
