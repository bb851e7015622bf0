//! Reasons why a file is refused.

use std::borrow::Cow;
use std::fmt;
use std::path::Path;

/// Refusal of a recording: the file, the place in it, the problem and the remedy.
#[derive(Debug, thiserror::Error)]
pub struct ReadError {
    /// Path of the file that is refused.
    pub file: Box<Path>,
    /// Data row, counted from 1 (the header is not a row).
    pub row: Option<usize>,
    /// Line of a text file, counted from 1 (the header is line 1).
    pub line: Option<u64>,
    /// Name of the column, as the file has it.
    pub column: Option<Box<str>>,
    /// The problem with the file.
    pub problem: Problem,
}

impl fmt::Display for ReadError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.file.display())?;
        if let Some(row) = self.row {
            write!(f, ", row {row}")?;
            if let Some(line) = self.line {
                write!(f, " (line {line})")?;
            }
        }
        if let Some(column) = &self.column {
            write!(f, ", column `{column}`")?;
        }
        write!(f, ": {}. {}", self.problem, self.problem.advice())
    }
}

/// Problem for which a file is refused.
#[derive(Debug, thiserror::Error)]
pub enum Problem {
    /// The file cannot be opened or read.
    #[error("cannot be read ({0})")]
    Io(#[from] std::io::Error),
    /// The ending of the name is not one of the formats.
    #[error("`{0}` is not a known kind of recording")]
    UnknownFormat(String),
    /// The file's container (Parquet, zip, MAT) is damaged or of an unknown kind.
    #[error("is not a readable {format} file ({detail})")]
    Damaged {
        /// Name of the container's format.
        format: &'static str,
        /// Message of the container's decoder.
        detail: String,
    },
    /// A file that ends before it is complete.
    #[error("ends at byte {at}, in the middle of a record")]
    CutOff {
        /// Length of the file, bytes.
        at: u64,
    },
    /// A chunk of unknown compression.
    #[error("has chunks of the compression `{0}`, which is not known")]
    Compression(String),
    /// A folder without recording.
    #[error("is a folder without .mcap or .db3 file")]
    NoBag,
    /// A table where a bag was asked for.
    #[error("is a table, not a bag of topics")]
    NoTopics,
    /// An SQLite file of something else.
    #[error("is an SQLite file without the tables `topics` and `messages` of a bag")]
    NoBagTables,
    /// An SQLite file whose last messages are not in it yet.
    #[error("was not closed: its last messages are in the file ending in -wal beside it")]
    Unfinished,
    /// A topic that is needed is not in the bag.
    #[error("topic `{missing}` is missing (the bag has: {present})")]
    MissingTopic {
        /// Name of the topic that is needed.
        missing: String,
        /// Names of the topics in the bag, with their types.
        present: String,
    },
    /// Bag without a topic of joint states.
    #[error("has no topic of the type sensor_msgs/JointState (the bag has: {0})")]
    NoJointStates(String),
    /// More than one topic could be meant.
    #[error("has the joints in several topics: {0}")]
    SeveralTopics(String),
    /// Messages that cannot be read for their type.
    #[error("topic `{topic}` of the type {kind} cannot be read: {reason}")]
    MessageType {
        /// Name of the topic whose messages cannot be read.
        topic: Box<str>,
        /// Type of the topic's messages.
        kind: Box<str>,
        /// Reason why the type cannot be read.
        reason: Box<str>,
    },
    /// A field that is needed is not in the messages.
    #[error("field `{missing}` with such values is missing (the messages have: {present})")]
    MissingField {
        /// Name of the field that is needed.
        missing: String,
        /// Names of the fields that the messages have.
        present: String,
    },
    /// Field that is needed and has no elements.
    #[error("field `{0}` is empty")]
    EmptyField(String),
    /// A field without names that has another number of elements than the robot has joints.
    #[error("field `{field}` has {found} elements, in which the {dof} joints have no place")]
    Elements {
        /// Name of the field with the wrong number.
        field: String,
        /// Number of elements of the field.
        found: usize,
        /// Number of joints of the robot.
        dof: usize,
    },
    /// A joint of the robot that the messages do not name.
    #[error("joint `{missing}` is missing (the messages have: {present})")]
    MissingJoint {
        /// Name of the joint that is missing, or of all of them.
        missing: String,
        /// Names of joints in the messages.
        present: String,
    },
    /// A message that is damaged.
    #[error("a message of `{topic}` {detail}")]
    Message {
        /// Name of the topic with the damaged message.
        topic: String,
        /// Defect of the message, as the second half of a sentence.
        detail: String,
    },
    /// The clock of a topic that goes back.
    #[error("the time of `{topic}` goes from {from} s to {to} s after its first message")]
    Backwards {
        /// Name of the topic whose clock goes back.
        topic: String,
        /// Time of the message before, s after the first one.
        from: f64,
        /// Time of the message that goes back, s after the first one.
        to: f64,
    },
    /// Topics that are to be joined and were recorded at different times.
    #[error("topics `{base}` and `{other}` have no time in common")]
    NoOverlap {
        /// The topic of the positions.
        base: String,
        /// The topic whose messages lie at other times.
        other: String,
    },
    /// Table without any row.
    #[error("has no samples")]
    Empty,
    /// Table without a header, or with a header of numbers.
    #[error("has no header with column names (it starts with `{0}`)")]
    NoHeader(String),
    /// Two columns have the same name.
    #[error("the name stands in the header {0} times")]
    DuplicateColumn(usize),
    /// A column that is needed is not there.
    #[error("column `{missing}` is missing (the file has: {present})")]
    MissingColumn {
        /// Name of the column that is needed.
        missing: Box<str>,
        /// Names of the columns that the file has.
        present: Box<str>,
        /// Lines of a drive file, filled in, that declare the column.
        declare: Option<Box<str>>,
    },
    /// Table in which no column is a torque.
    #[error("no column is a torque: `{missing}` is missing (the file has: {present})")]
    NoTorque {
        /// Names by which a torque column is looked for.
        missing: String,
        /// Names of the columns that the file has.
        present: String,
    },
    /// Bag of ROS 1, which is not read.
    #[error("is a ROS 1 bag")]
    Ros1Bag,
    /// Numbers that lay in memory before.
    #[error("the value {0:e} is no measurement, but what lay in memory before one was written")]
    Unfilled(f64),
    /// Two sources write into one log.
    #[error("{}", two_sources(*.zeros))]
    TwoSources {
        /// The torque of the second is zero throughout.
        zeros: bool,
    },
    /// A number of joints other than the robot's.
    #[error("{}", wrong_dof(*.expected, *.found, .columns, .model.as_deref()))]
    WrongDof {
        /// Number of joints of the robot.
        expected: usize,
        /// Number of joints in the file.
        found: usize,
        /// Names of their columns, or of the joints of a message.
        columns: Box<str>,
        /// Names of the joints of the stored model; none where the user chooses robot and joints.
        model: Option<Box<str>>,
    },
    /// A row with another number of cells than the header.
    #[error("has {found} cells, the header has {expected}")]
    RowLength {
        /// Number of cells of the header.
        expected: u64,
        /// Number of cells of the row.
        found: u64,
    },
    /// A cell that is not a number.
    #[error("`{0}` is not a number")]
    NotANumber(String),
    /// An empty cell, or a null.
    #[error("the value is missing")]
    MissingValue,
    /// Value that is NaN or infinite.
    #[error("the value is {0}")]
    NotFinite(f64),
    /// A column of a type that holds neither numbers nor labels.
    #[error("has the type {0}, which is neither a number nor a label")]
    ColumnType(String),
    /// A table with another shape than needed.
    #[error("has the shape {found:?}, needed is {needed}")]
    Shape {
        /// Shape of the table in the file.
        found: Vec<usize>,
        /// Shape that is needed, in words.
        needed: String,
    },
    /// Time that stands still or goes back inside a trajectory.
    #[error("time goes from {from} s to {to} s inside trajectory `{trajectory}`")]
    TimeNotIncreasing {
        /// Time of the row before, s.
        from: f64,
        /// Time of the row that does not increase, s.
        to: f64,
        /// Label of the trajectory in which it happens.
        trajectory: String,
    },
    /// Fewer samples than the filter needs.
    #[error("trajectory `{trajectory}` has {samples} samples, at least {needed} are needed")]
    TooShort {
        /// Label of the trajectory that is too short.
        trajectory: String,
        /// Number of samples of the trajectory.
        samples: usize,
        /// Least number of samples that the filter needs.
        needed: usize,
    },
    /// The benchmark's .mat files without the benchmark's robot.
    #[error("a .mat file is read as the KR300 benchmark, but the robot is another one")]
    MatNeedsKr300,
    /// A trajectory of the official .mat layout does not start at rest.
    #[error(
        "executions of {seconds} s were expected to start at rest, but joint {joint} moves at {speed_deg_s:.2} deg/s"
    )]
    NotAtRest {
        /// Length of an execution in s.
        seconds: f64,
        /// Number of the joint that moves, from 1.
        joint: usize,
        /// Speed at the start, deg/s.
        speed_deg_s: f64,
    },
}

/// Words of [`Problem::WrongDof`].
fn wrong_dof(expected: usize, found: usize, columns: &str, model: Option<&str>) -> String {
    let has = format!("has columns for {found} joints ({columns})");
    match model {
        Some(joints) => format!("{has}, the model has {expected} ({joints})"),
        None => format!("{has}, the robot has {expected}"),
    }
}

fn two_sources(zeros: bool) -> &'static str {
    if zeros {
        "all torques are zero in rows that alternate with others from here on: two sources write into one log"
    } else {
        "every second row holds another signal than its neighbours: two sources write into one log"
    }
}

impl Problem {
    /// Remedy for the problem, as a sentence.
    pub fn advice(&self) -> Cow<'static, str> {
        if let Self::MissingColumn {
            declare: Some(text),
            ..
        } = self
        {
            // Lines of a file are copied as they stand.
            let end = if text.contains('\n') { "" } else { "." };
            return Cow::Owned(format!("{text}{end}"));
        }
        Cow::Borrowed(match self {
            Self::Io(_) => "Check the path and its permissions.",
            Self::UnknownFormat(_) => {
                "Give a .csv (.txt, .tsv), .parquet, .npz, .mcap, .db3 or (KR300) .mat file, or a rosbag2 folder."
            }
            Self::CutOff { .. } => {
                "Copy the file again, or save what it holds with `mcap recover`."
            }
            Self::Compression(_) => "Write it with lz4, zstd or none (`mcap compress`).",
            Self::NoTopics => "Look at its header.",
            Self::NoBag => {
                "Give the folder that `ros2 bag record` has written, a LeRobot data set (with meta/info.json), or a file."
            }
            Self::NoBagTables => "Give a file that `ros2 bag record` has written.",
            Self::Unfinished => "Convert it with `ros2 bag convert`, which reads both.",
            Self::MissingTopic { .. } => {
                "Name one of them in the [columns] table of --drive (q = \"/TOPIC:FIELD\"), or record it."
            }
            Self::NoJointStates(_) => {
                "Name topic and field in the [columns] table of --drive (q = \"/TOPIC:FIELD\")."
            }
            Self::SeveralTopics(_) => {
                "Choose one in the [columns] table of --drive (q = \"/TOPIC\")."
            }
            Self::MessageType { .. } => {
                "Record it as MCAP with the definitions of its types, or name another topic in the [columns] table of --drive."
            }
            Self::MissingField { .. } | Self::EmptyField(_) => {
                "Name the field, or another topic's (\"/TOPIC:FIELD\"), in the [columns] table of --drive."
            }
            Self::Elements { .. } => {
                "Name each joint's element in the [columns] table of --drive (q1 = \"/TOPIC:FIELD[0]\", …)."
            }
            Self::MissingJoint { .. } => {
                "Give the robot that made the recording, or its own names of the joints in the [columns] table of --drive (joint1 = \"…\")."
            }
            Self::Message { .. } => "Record it again, or cut the bag before this message.",
            Self::Backwards { .. } => "Cut the bag there into one for each run.",
            Self::NoOverlap { .. } => {
                "Record them together, on one clock (their stamps may come from different machines)."
            }
            Self::Damaged { .. } => "Export or copy the file again.",
            Self::Empty => "Record some motion, or give another file.",
            Self::NoHeader(_) => {
                "Write the column names (time, q1, …, tau1, …) in the first line, or under columns.header in --drive."
            }
            Self::DuplicateColumn(_) => "Rename or remove all but one of them.",
            Self::MissingColumn { .. } => {
                "Add the column, or name the file's own column in the [columns] table of --drive."
            }
            Self::WrongDof { model: Some(_), .. } => {
                "Give one column for each joint of the model, base first (q1, q2, …), or name them in the [columns] table of --drive (q1 = \"…\")."
            }
            Self::WrongDof { .. } => {
                "Give the robot that made the recording, with one column per moving joint, or choose its recorded joints by --joints, or name those of \
                 the chain in the [columns] table of --drive (q1 = \"…\", tau1 = \"…\")."
            }
            Self::RowLength { .. } => "Repair or remove the row.",
            Self::NotANumber(_) | Self::MissingValue => "Write a number there, or remove the row.",
            Self::NotFinite(_) => {
                "Remove the row, or start a new trajectory after it; values are never made up."
            }
            Self::ColumnType(_) => "Store it as 32 or 64 bit numbers (labels: text or integers).",
            Self::Shape { .. } => "Store one row per sample.",
            Self::TimeNotIncreasing { from, to, .. } if from == to => {
                "Stamps repeat: write them with more digits (an epoch in 32 bits has steps of 128 s), leave out rows that stand twice, or leave \
                 out the column and give the rate by --rate HZ."
            }
            Self::TimeNotIncreasing { .. } => {
                "Sort the rows, or give each run its own label in the column `trajectory`."
            }
            Self::TooShort { .. } => {
                "Record it longer, remove its rows, or join it with its neighbour."
            }
            Self::MatNeedsKr300 => "Use --robot kr300, or export the data as CSV or Parquet.",
            Self::NotAtRest { .. } => {
                "Export the file as Parquet with a column `trajectory` that marks the executions."
            }
            Self::NoTorque { .. } => {
                "Name it in the [columns] table of --drive (tau = \"…{}\"). Without torque nothing can be identified; `residyn replay` compares \
                 a motion with its command, and a model that is there predicts the torque (`eval --predict OUT.csv`)."
            }
            Self::Ros1Bag => {
                "Convert it (pip install rosbags; rosbags-convert --src run.bag --dst run), and give the folder."
            }
            Self::Unfilled(_) => {
                "Leave the value empty where there was none, and record or export the field anew; values are never made up."
            }
            Self::TwoSources { .. } => {
                "Keep the rows of one of them, for example by the name of the publisher or every second row."
            }
        })
    }

    /// The problem at no particular place of `file`.
    pub(crate) fn in_file(self, file: &Path) -> ReadError {
        ReadError {
            file: file.into(),
            row: None,
            line: None,
            column: None,
            problem: self,
        }
    }

    /// The problem with a column of `file`.
    pub(crate) fn in_column(self, file: &Path, column: &str) -> ReadError {
        ReadError {
            column: Some(column.into()),
            ..self.in_file(file)
        }
    }
}

impl ReadError {
    /// Error with its data row, which is given here counted from 0.
    pub(crate) fn at_row(mut self, row: usize) -> Self {
        self.row = Some(row + 1);
        self
    }
}
