//! MJCF: equality with MuJoCo on the values of `fixtures/mjcf.py`, what is said and refused, and new numbers in the files.

mod models;
mod reading;
mod refusals;
mod values;
mod writing;
