//! The programs at work: what they print, write and refuse.

mod bags;
mod config;
mod doctor;
mod first_diagnosis;
mod first_screen;
mod forward;
mod heldout;
mod interruption;
mod kinds;
mod leaderboard;
mod mjcf;
mod onnx;
mod payload;
mod plan;
mod refusals;
mod repeated;
mod repro;
mod scores;
mod unread;
mod yardsticks;
