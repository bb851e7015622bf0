//! Where the gap between a simulator's torque and a real robot's lies, which unmodelled effects cause
//! it, and how far it shrinks.
//!
//! [`diagnose`] takes the simulator's model and two recordings to an [`Outcome`]. The way there, room by room, each
//! using only those before it (the names of effects, of `catalogue`, are everywhere):
//!
//! | room | what stands there |
//! |---|---|
//! | `settings` | every number that decides, by room |
//! | `algebra` | sums of products, their factors, penalised fits |
//! | `motion` | one recording's motion: clocks, what columns see of it, where it stands |
//! | `simulator` | the model that the gap is measured from |
//! | `schema` | the report as the JSON file has it |
//! | `input` | model and recordings: read, checked, prepared |
//! | `traces` | what is seen in a residual itself: pushes, blows, lines of position |
//! | `catalogue` | every effect as columns of torque |
//! | `search` | from the catalogue to the causes |
//! | `ladder` | fits of what was found, and which causes are listed |
//! | `surrogates` | the recording as it would be if nothing were missing, or if a cause or its rival were true |
//! | `measure` | shares, sizes, intervals, what is left, the verdict |
//! | `advice` | corrected model, next motion, what a motion would show |
//! | `report` | words and page |
//!
//! Cases that prove it, and the program `diagnose`, are the crate `proof`.
#![forbid(unsafe_code)]

mod advice;
mod algebra;
mod catalogue;
mod diagnosis;
mod error;
mod input;
mod job;
mod ladder;
mod measure;
mod motion;
mod outcome;
mod report;
pub mod schema;
mod search;
pub mod settings;
mod simulator;
mod surrogates;
mod traces;

pub use crate::report::{layouts, page, words};
pub use advice::visibility::{Visible, visible};
pub use advice::{directory, next_motion, patch};
pub use catalogue::choice::Choice;
pub use catalogue::effect::Effect;
pub use catalogue::info::{Info, Need};
pub use catalogue::{Shape, Unit};
pub use diagnosis::{Baseline, Earlier, Options, Prepared, diagnose};
pub use error::DiagnoseError;
pub use input::given::Given;
pub use job::{Done, Job, SURROGATES, Subject};
pub use measure::confidence;
pub use outcome::Outcome;
pub use settings::Settings;
pub use simulator::NominalModel;
