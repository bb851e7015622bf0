//! The programs under one name, each the function that its crate gives for it.

mod demo;
mod reports;

use clap::Command;
use std::ffi::OsString;
use std::iter::once;
use std::process::ExitCode;

/// A program by its name, with what it is for and what runs it.
struct Program {
    name: &'static str,
    about: &'static str,
    command: fn() -> Command,
    run: fn(Vec<OsString>) -> ExitCode,
}

const PROGRAMS: &[Program] = &[
    Program {
        name: "demo",
        about: "A first look: a simulated arm with an unknown load is diagnosed",
        command: demo::command,
        run: demo::command_line,
    },
    #[cfg(feature = "programs")]
    Program {
        name: "train",
        about: "A torque model from recordings",
        command: train::command,
        run: train::command_line,
    },
    #[cfg(feature = "programs")]
    Program {
        name: "eval",
        about: "Scores and predictions of a model on a recording; leaderboards, closed loops, collisions",
        command: eval::command,
        run: eval::command_line,
    },
    Program {
        name: "diagnose",
        about: "What a simulator gets wrong: where, which effect, how far it shrinks; the corrected model",
        command: proof::command,
        run: proof::command_line,
    },
    Program {
        name: "replay",
        about: "The gap in motion, from commands and encoders: where, which effect, how far it shrinks",
        command: proof::motion::command,
        run: proof::motion::command_line,
    },
    #[cfg(feature = "programs")]
    Program {
        name: "excite",
        about: "The motion to record, and what it would show",
        command: excite::command,
        run: excite::command_line,
    },
    #[cfg(feature = "programs")]
    Program {
        name: "payload",
        about: "The body on the last link, from a recording with it",
        command: payload::command,
        run: payload::command_line,
    },
    #[cfg(feature = "programs")]
    Program {
        name: "feedforward",
        about: "The torque of a planned motion, for a controller to feed forward",
        command: plan::command,
        run: plan::command_line,
    },
    #[cfg(feature = "reproductions")]
    Program {
        name: "machine",
        about: "Axes, SCARA, Delta, PUMA as a motion controller identifies them",
        command: machines::command,
        run: machines::command_line,
    },
    #[cfg(feature = "reproductions")]
    Program {
        name: "decoupled",
        about: "Single joints under their controller",
        command: decoupled::command,
        run: decoupled::command_line,
    },
    Program {
        name: "report",
        about: "Two runs side by side: verdict, error by joint, causes, what changed",
        command: reports::command,
        run: reports::command_line,
    },
    Program {
        name: "simulate",
        about: "Recordings of simulated robots",
        command: trials::command,
        run: trials::command_line,
    },
];

/// Runs the program that the arguments name, and returns its exit status. The first of the arguments is the name by which
/// `residyn` was called. `--help` and wrong usage of a program end the process here, as clap does it.
pub fn command_line(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let given: Vec<OsString> = arguments.into_iter().skip(1).collect();
    if let Some((program, arguments)) = asked(&given) {
        let called = OsString::from(format!("residyn {}", program.name));
        return (program.run)(once(called).chain(arguments).collect());
    }
    // No program's name stands first: the list, the version, or what was meant.
    let matches = list().try_get_matches_from(once("residyn".into()).chain(given));
    let error = matches.expect_err("every program's name was looked for");
    let _ = error.print();
    ExitCode::from(if error.use_stderr() { 2 } else { 0 })
}

/// The program that is named first, or after `help`, and its arguments.
fn asked(given: &[OsString]) -> Option<(&'static Program, Vec<OsString>)> {
    let named = |word: &OsString| PROGRAMS.iter().find(|p| word == p.name);
    match given {
        [help, word, ..] if help == "help" => Some((named(word)?, vec!["--help".into()])),
        [word, rest @ ..] => Some((named(word)?, rest.to_vec())),
        [] => None,
    }
}

/// The programs as clap lists them.
fn list() -> Command {
    let each = PROGRAMS.iter().map(|p| Command::new(p.name).about(p.about));
    alone().subcommands(each)
}

/// The programs with all that each of them takes, for manual pages and shells.
pub fn command() -> Command {
    let each = PROGRAMS.iter().map(|p| (p.command)().name(p.name));
    alone().subcommands(each)
}

/// `residyn` without its programs.
fn alone() -> Command {
    Command::new("residyn")
        .version(program::VERSION)
        .about("Torque models of robot arms, and what a simulator gets wrong")
        .after_help("Each has its own: residyn diagnose --help")
        .subcommand_required(true)
        .arg_required_else_help(true)
}
