//! Torque models of robot arms: from a description and recordings to a model that runs in a control loop, and to an explanation
//! of what a simulator gets wrong.
//!
//! The crates of the workspace under one name, and what most programs need of them at its root. The program `residyn` does the
//! same from files (`residyn train`, `residyn diagnose`, …); `default-features = false` leaves it out.
//!
//! # A robot and its dynamics
//! A built-in name, or a URDF or MJCF by path. Joint quantities are slices, base first; SI units.
//! ```
//! use residyn::{Robot, Workspace, inverse_dynamics, regressor};
//!
//! let (robot, _) = Robot::load("ur5", &[])?;
//! let (q, qd, qdd) = ([0.1, -1.2, 0.8, 0.3, 0.5, 0.0], [0.4; 6], [-0.2; 6]);
//! let mut workspace = Workspace::new(&robot);
//! let mut tau = [0.0; 6];
//! inverse_dynamics(&robot, &mut workspace, &q, &qd, &qdd, &mut tau);
//!
//! // The same torque is linear in ten parameters for each link.
//! let parameters = robot.parameters();
//! let mut y = vec![0.0; 6 * parameters.len()];
//! regressor(&robot, &mut workspace, &q, &qd, &qdd, &mut y);
//! for (row, tau) in y.chunks_exact(parameters.len()).zip(tau) {
//!     let linear: f64 = row.iter().zip(&parameters).map(|(y, p)| y * p).sum();
//!     assert!((linear - tau).abs() < 1e-10);
//! }
//! # Ok::<(), residyn::RobotError>(())
//! ```
//!
//! # From a recording to a model in a control loop
//! A recording is read from a file (CSV, Parquet, NPZ, MCAP, rosbag2), or made of tables as here.
//! ```
//! use ndarray::Array2;
//! use residyn::{Feedforward, FitOptions, Recording, Robot, Workspace, fit_physics, inverse_dynamics};
//!
//! # let robot = Robot::load("ur5", &[])?.0;
//! # let (rows, rate) = (3000, 100.0);
//! # let motion = |t: f64, j: usize| {
//! #     let (a, b) = (0.7 + 0.13 * j as f64, 1.9 - 0.17 * j as f64);
//! #     let at = |w: f64, p: f64| [(w * t + p).sin(), w * (w * t + p).cos(), -w * w * (w * t + p).sin()];
//! #     let (x, y) = (at(a, j as f64), at(b, 2.0 * j as f64));
//! #     [0, 1, 2].map(|d| 0.5 * x[d] + 0.3 * y[d])
//! # };
//! # let table = |d: usize| Array2::from_shape_fn((rows, 6), |(i, j)| motion(i as f64 / rate, j)[d]);
//! # let [q, qd, qdd] = [0, 1, 2].map(table);
//! # let time: Vec<f64> = (0..rows).map(|i| i as f64 / rate).collect();
//! # let mut tau = Array2::zeros((rows, 6));
//! # let mut workspace = Workspace::new(&robot);
//! # for (i, mut row) in tau.rows_mut().into_iter().enumerate() {
//! #     let at = [&q, &qd, &qdd].map(|t| t.row(i).to_vec());
//! #     let mut torque = [0.0; 6];
//! #     inverse_dynamics(&robot, &mut workspace, &at[0], &at[1], &at[2], &mut torque);
//! #     for j in 0..6 {
//! #         row[j] = torque[j] + 3.0 * at[1][j] + 2.0 * at[1][j].signum();
//! #     }
//! # }
//! // q, tau: tables of shape (samples, joints); time in s.
//! let recording = Recording::new("simulated", time, q, Some(tau));
//! let fit = fit_physics(&robot, &[recording], None, &FitOptions::default())?;
//!
//! let folder = tempfile::tempdir()?;
//! fit.file.save(folder.path())?;
//! let mut model = Feedforward::load(folder.path(), Some(0.001))?;
//! let mut torque = [0.0; 6];
//! // Every millisecond, without allocation:
//! model.torque(&[0.1; 6], &[0.5; 6], &[0.0; 6], &mut torque);
//! # let mut rigid = [0.0; 6];
//! # inverse_dynamics(&robot, &mut workspace, &[0.1; 6], &[0.5; 6], &[0.0; 6], &mut rigid);
//! # for j in 0..6 {
//! #     assert!((torque[j] - rigid[j] - 3.5).abs() < 0.2, "joint {j}: {} and {}", torque[j], rigid[j] + 3.5);
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//! Networks on what the physics leaves are trained by [`model::residual`], as `residyn train` calls it.
//!
//! # What does the simulator get wrong?
//! ```no_run
//! use residyn::{Job, Subject};
//!
//! let job = Job::new(Subject::robot("simulator.urdf"), vec!["monday.csv".into()], "friday.csv");
//! let done = job.run(|stage| eprintln!("{stage} …"))?;
//! for cause in &done.outcome.diagnosis.causes {
//!     println!("{} of {:?} closes {:.0} %", cause.effect.name(), cause.joints, 100.0 * cause.gap_closed);
//! }
//! for (path, text) in done.patch()?.files("corrected.urdf".as_ref())? {
//!     std::fs::write(path, text)?;
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What do its drives get wrong?
//! Commands and positions are enough, and no torque is needed. Recordings lie in memory here, as those of a control loop do; files are read
//! by [`replay::Job`].
//! ```no_run
//! use residyn::physics::robot::drive::Drive;
//! use residyn::replay::{Options, Subject};
//! use residyn::{Recording, Robot, replay};
//!
//! # let [monday, friday]: [Recording; 2] = unimplemented!();
//! let robot = Robot::from_urdf_file("simulator.urdf")?;
//! let drive = Drive::from_file("drive.toml", &robot)?; // its block [controller]
//! // Recordings with commanded positions: `q_ref: Some(…)`.
//! let done = replay(Subject::of(robot, drive)?, &[monday], &friday, Options::default(), |stage| eprintln!("{stage} …"))?;
//! for cause in &done.outcome.report.causes {
//!     println!("{} of {:?} closes {:.0} %", cause.effect, cause.joints, 100.0 * cause.gap_closed);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! Eleven short programs stand in `examples/`.
#![forbid(unsafe_code)]

#[cfg(feature = "diagnosis")]
#[doc(hidden)]
pub mod programs;

pub use {datasets, diagnose, feedforward, identify, model, physics, report, signal, trials};
// The crate and, of the same name, its function.
pub use ::replay;
pub use ::replay::replay;

pub use datasets::{ReadOptions, Recording, Trajectory, read, write};
pub use diagnose::{Done, Job, Subject};
pub use feedforward::Feedforward;
pub use model::directory::ModelFile;
pub use model::physics_fit::{Fit, FitOptions, fit_physics};
pub use model::preparation::setup::Setup;
pub use physics::dynamics::{
    Workspace, forward_dynamics, inverse_dynamics, mass_matrix, regressor,
};
pub use physics::robot::{Robot, RobotError};
