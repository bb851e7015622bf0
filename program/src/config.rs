//! Options of a program from a file: `--config residyn.toml`. The command line wins.

use clap::{Arg, ArgAction, Command, CommandFactory, FromArgMatches, value_parser};
use std::ffi::{OsStr, OsString};
use std::path::{Path, PathBuf};
use std::process::exit;
use toml::{Table, Value};

/// Name of the option.
const NAME: &str = "config";

/// A file of options that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// The file cannot be read.
    #[error("{}: {source}", path.display())]
    Open {
        /// File of options.
        path: PathBuf,
        /// Error of the operating system.
        source: std::io::Error,
    },
    /// The file is no TOML.
    #[error("{}: no TOML: {}", path.display(), source.to_string().trim().replace('\n', " "))]
    Toml {
        /// File of options.
        path: PathBuf,
        /// Error with line and column.
        source: Box<toml::de::Error>,
    },
    /// A key that is no option of the program.
    #[error("{}: {program} has no option `{key}`; did you mean `{nearest}`?", path.display())]
    Unknown {
        /// File of options.
        path: PathBuf,
        /// Name of the program.
        program: String,
        /// Key in the file.
        key: String,
        /// Option with the most similar name.
        nearest: String,
    },
    /// A value that no command line has.
    #[error("{}: `{key}` is a {found}; text, a number, true, false or a list of those is needed", path.display())]
    Value {
        /// File of options.
        path: PathBuf,
        /// Key in the file.
        key: String,
        /// Type of its value.
        found: &'static str,
    },
}

/// A program's command line with `--config`.
pub fn with_config(command: Command) -> Command {
    command.arg(
        Arg::new(NAME)
            .long(NAME)
            .value_name("FILE.toml")
            .value_parser(value_parser!(PathBuf))
            .help("File with options by their names, as `data = [\"monday.csv\"]`; a table by this program's name holds options of it alone. Paths are relative to the working directory. The command line wins"),
    )
}

/// Options of a program whose name is the first of `arguments`, from them and from the file that `--config` names. Wrong usage, a
/// wrong file and `--help` end the process, as clap does it.
pub fn parse<P: CommandFactory + FromArgMatches>(
    arguments: impl IntoIterator<Item = OsString>,
) -> P {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let command = with_config(P::command());
    let filled = match named(&arguments) {
        Some(path) => filled(&command, arguments, &path),
        None => Ok(arguments),
    };
    let arguments = filled.unwrap_or_else(|error| {
        report::warn!("error: {error}");
        exit(2)
    });
    let matches = command.get_matches_from(arguments);
    P::from_arg_matches(&matches).unwrap_or_else(|error| error.exit())
}

/// File that the command line names.
fn named(arguments: &[OsString]) -> Option<PathBuf> {
    let own = arguments.iter().position(|a| is(a, NAME))?;
    match arguments[own].to_str()?.split_once('=') {
        Some((_, path)) => Some(path.into()),
        None => arguments.get(own + 1).map(PathBuf::from),
    }
}

/// Whether a word of the command line is the option `--long`, with or without `=VALUE`.
fn is(word: &OsStr, long: &str) -> bool {
    let option = word.to_str().and_then(|w| w.strip_prefix("--"));
    option.is_some_and(|o| o.split('=').next() == Some(long))
}

/// The command line with the file's options before its own.
fn filled(
    command: &Command,
    arguments: Vec<OsString>,
    path: &Path,
) -> Result<Vec<OsString>, ConfigError> {
    let text = std::fs::read_to_string(path).map_err(|source| ConfigError::Open {
        path: path.to_owned(),
        source,
    })?;
    let table: Table = toml::from_str(&text).map_err(|source| ConfigError::Toml {
        path: path.to_owned(),
        source: Box::new(source),
    })?;
    let mut options = Vec::new();
    for (key, value) in &table {
        match value {
            // Tables hold options of one program alone.
            Value::Table(own) if key == command.get_name() => options.extend(own),
            Value::Table(_) if PROGRAMS.contains(&key.as_str()) => {}
            _ => options.push((key, value)),
        }
    }
    let (name, own) = arguments.split_first().expect("a program has a name");
    let mut out = vec![name.clone()];
    for (key, value) in options {
        let long = key.replace('_', "-");
        let option = command
            .get_arguments()
            .find(|a| a.get_long() == Some(&long) && long != NAME);
        let option = option.ok_or_else(|| ConfigError::Unknown {
            path: path.to_owned(),
            program: command.get_name().to_owned(),
            key: key.clone(),
            nearest: nearest(command, &long),
        })?;
        if !own.iter().any(|word| is(word, &long)) {
            out.extend(words(path, key, option, value)?);
        }
    }
    out.extend(own.iter().cloned());
    Ok(out)
}

/// Programs that read a file of options.
const PROGRAMS: [&str; 4] = ["diagnose", "eval", "replay", "train"];

/// Words of the command line for an option with this value.
fn words(
    path: &Path,
    key: &str,
    option: &Arg,
    value: &Value,
) -> Result<Vec<OsString>, ConfigError> {
    let single = |value: &Value| match value {
        Value::String(text) => Ok(text.clone()),
        Value::Integer(number) => Ok(number.to_string()),
        Value::Float(number) => Ok(number.to_string()),
        other => Err(ConfigError::Value {
            path: path.to_owned(),
            key: key.to_owned(),
            found: other.type_str(),
        }),
    };
    let name = format!("--{}", option.get_long().unwrap_or_default());
    let flag = matches!(option.get_action(), ArgAction::SetTrue);
    let words = match value {
        Value::Boolean(on) if flag => Vec::from_iter(on.then_some(name)),
        Value::Array(list) => {
            let values: Vec<String> = list.iter().map(single).collect::<Result<_, _>>()?;
            match option.get_value_delimiter() {
                Some(mark) => vec![format!("{name}={}", values.join(&mark.to_string()))],
                None => std::iter::once(name).chain(values).collect(),
            }
        }
        // So a value may begin with a dash.
        value => vec![format!("{name}={}", single(value)?)],
    };
    Ok(words.into_iter().map(OsString::from).collect())
}

/// Name of the program's option that the fewest changes of letters turn into `long`.
fn nearest(command: &Command, long: &str) -> String {
    let longs = command.get_arguments().filter_map(Arg::get_long);
    let nearest = longs.min_by_key(|known| strsim::levenshtein(known, long));
    nearest.unwrap_or_default().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::Parser;

    /// Options like those of a program.
    #[derive(Debug, PartialEq, Parser)]
    #[command(name = "diagnose")]
    struct Options {
        #[arg(long, num_args = 1..)]
        data: Vec<PathBuf>,
        #[arg(long, value_delimiter = ',')]
        joints: Vec<String>,
        #[arg(long)]
        cutoff_hz: Option<f64>,
        #[arg(long)]
        fast: bool,
    }

    /// The command line that comes of a file and a command line.
    fn of(text: &str, own: &[&str]) -> Result<Options, String> {
        let file = tempfile::NamedTempFile::new().expect("a temporary file");
        std::fs::write(&file, text).expect("a temporary file");
        let own = own.iter().map(OsString::from);
        let arguments = std::iter::once("diagnose".into()).chain(own).collect();
        let command = with_config(Options::command());
        let arguments = filled(&command, arguments, file.path()).map_err(|e| e.to_string())?;
        Options::try_parse_from(arguments).map_err(|e| e.to_string())
    }

    #[test]
    fn options_come_from_the_file_and_the_command_line_wins() {
        let text = "data = ['a.csv', 'b.csv']\njoints = ['x', 'y']\n[diagnose]\ncutoff_hz = 8\nfast = true\n[train]\nseed = 1";
        let found = of(text, &[]).expect("options");
        assert_eq!(found.data, ["a.csv", "b.csv"].map(PathBuf::from));
        assert_eq!((found.cutoff_hz, found.fast), (Some(8.0), true));
        assert_eq!(found.joints, ["x", "y"]);
        let own = of(text, &["--data=c.csv", "--cutoff-hz", "5"]).expect("options");
        assert_eq!(own.data, [PathBuf::from("c.csv")]);
        assert_eq!((own.cutoff_hz, own.joints.len()), (Some(5.0), 2));
        assert!(!of("fast = false", &[]).expect("options").fast);
    }

    #[test]
    fn what_is_no_option_is_refused_with_the_nearest_one() {
        let wrong = |text: &str| of(text, &[]).expect_err("a refusal");
        assert!(wrong("datas = 'a.csv'").contains("`datas`; did you mean `data`?"));
        assert!(wrong("[diagnos]\nfast = true").contains("`diagnos`"));
        assert!(wrong("config = 'other.toml'").contains("`config`"));
        assert!(wrong("cutoff-hz = 1979-05-27").contains("is a datetime"));
        assert!(wrong("data = [").contains("no TOML"));
    }

    #[test]
    fn the_file_is_what_the_command_line_names() {
        let named = |words: &[&str]| named(&words.iter().map(OsString::from).collect::<Vec<_>>());
        assert_eq!(named(&["x", "--config", "a.toml"]), Some("a.toml".into()));
        assert_eq!(named(&["x", "--config=b.toml"]), Some("b.toml".into()));
        assert_eq!(named(&["x", "--configs", "a.toml"]), None);
    }
}
