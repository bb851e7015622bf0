//! Columns that can be shifted by any delay, and the residual at a delay.

use super::cubic::{b_spline, slopes, weights};
use super::products::{add_row, dot, fitted, own_part, sums};
use super::system::{Delay, Search, System};
use crate::correlation::correlation_time;
use std::ops::Range;

/// Products of columns (with the target last) over some rows.
type Products = Vec<f64>;

/// A system whose columns can be shifted.
pub(super) struct Shifted<'a> {
    system: &'a System,
    splines: Vec<Vec<f64>>,
    /// Rows at which every shift of the search stays within its segment, with the segment's step.
    rows: Vec<(Range<usize>, f64)>,
}

impl<'a> Shifted<'a> {
    pub fn new(system: &'a System, search: &Search) -> Option<Self> {
        let mut rows = Vec::new();
        for (segment, &step) in system.segments.iter().zip(&system.steps) {
            let before = (search.range[1].max(0.0) / step).ceil() as usize + 2;
            let after = (-search.range[0].min(0.0) / step).ceil() as usize + 2;
            if segment.len() > before + after {
                rows.push((segment.start + before..segment.end - after, step));
            }
        }
        let count: usize = rows.iter().map(|(r, _)| r.len()).sum();
        if count < 3 * (system.columns.len() + 1) {
            return None;
        }
        let spline = |column: &Vec<f64>| -> Vec<f64> {
            let mut out = vec![0.0; column.len()];
            for s in &system.segments {
                out[s.clone()].copy_from_slice(&b_spline(&column[s.clone()]));
            }
            out
        };
        Some(Self {
            system,
            splines: system.columns.iter().map(spline).collect(),
            rows,
        })
    }

    /// Values (and, with `slope`, derivatives by time) of all columns at the rows less `delay`, row by row.
    pub fn columns(&self, delay: f64, slope: bool) -> Vec<f64> {
        let p = self.splines.len();
        let mut out = vec![0.0; p * self.rows.iter().map(|(r, _)| r.len()).sum::<usize>()];
        let mut at = 0;
        for (rows, step) in &self.rows {
            let place = -delay / step;
            let (whole, part) = (place.floor() as isize, place - place.floor());
            let w = if slope {
                slopes(part).map(|w| w / step)
            } else {
                weights(part)
            };
            for row in rows.clone() {
                let first = (row as isize + whole - 1) as usize;
                for (value, c) in out[at..at + p].iter_mut().zip(&self.splines) {
                    let c = &c[first..first + 4];
                    *value = w[0] * c[0] + w[1] * c[1] + w[2] * c[2] + w[3] * c[3];
                }
                at += p;
            }
        }
        out
    }

    pub fn target(&self) -> impl Iterator<Item = f64> + '_ {
        let rows = self.rows.iter().flat_map(|(r, _)| r.clone());
        rows.map(|row| self.system.target[row])
    }

    /// Residual sum of squares at a delay.
    pub fn error(&self, delay: f64) -> f64 {
        let p = self.splines.len();
        let x = self.columns(delay, false);
        let y: Vec<f64> = self.target().collect();
        fitted(&sums(&x, p, &y), p).1
    }

    /// The delay with its deviation: one Gauss–Newton step about it with each block left out.
    pub fn judged(&self, delay: f64, shortest: f64) -> Option<Delay> {
        let p = self.splines.len();
        let x = self.columns(delay, false);
        let slope = self.columns(delay, true);
        let y: Vec<f64> = self.target().collect();
        let (coefficients, _) = fitted(&sums(&x, p, &y), p);
        // ∂(Xβ)/∂d beside the columns.
        let lines: Vec<(Vec<f64>, f64)> = x
            .chunks(p)
            .zip(slope.chunks(p))
            .zip(self.target())
            .map(|((row, slope), y)| {
                let change = -dot(slope, &coefficients);
                let line: Vec<f64> = row.iter().copied().chain([change]).collect();
                (line, y)
            })
            .collect();
        let residual: Vec<f64> = lines
            .iter()
            .map(|(line, y)| y - dot(&line[..p], &coefficients))
            .collect();
        let score: Vec<f64> = residual
            .iter()
            .zip(&lines)
            .map(|(e, (l, _))| e * l[p])
            .collect();
        let mut blocks = Vec::new();
        let mut start = 0;
        for (rows, step) in &self.rows {
            let own = start..start + rows.len();
            let time = correlation_time(&[&residual[own.clone()], &score[own.clone()]]) * step;
            let size = shortest.max(4.0 * time) / step;
            // Eight blocks at least, however correlated: then the quantile is what is wide.
            let most = (rows.len() as f64 / (size.max(1.0))).round().max(1.0) as usize;
            let count = if self.rows.len() < 8 {
                most.max(8usize.div_ceil(self.rows.len()))
            } else {
                most
            };
            for k in 0..count {
                let cut = |k: usize| own.start + k * rows.len() / count;
                blocks.push(cut(k)..cut(k + 1));
            }
            start = own.end;
        }
        let of = |rows: Range<usize>| -> Products {
            let mut sums = vec![0.0; (p + 2) * (p + 2)];
            for (line, y) in &lines[rows] {
                add_row(&mut sums, line, *y);
            }
            sums
        };
        let parts: Vec<Products> = blocks.into_iter().map(of).collect();
        let mut whole = vec![0.0; (p + 2) * (p + 2)];
        for part in &parts {
            whole.iter_mut().zip(part).for_each(|(w, v)| *w += v);
        }
        let (_, with) = fitted(&whole, p + 1);
        let own = own_part(&whole, p + 1);
        let size = whole[p * (p + 2) + p];
        if own.is_nan() || own <= 1e-9 * size || size <= 0.0 {
            return None;
        }
        let steps: Vec<f64> = parts
            .iter()
            .map(|part| {
                let rest: Products = whole.iter().zip(part).map(|(w, v)| w - v).collect();
                fitted(&rest, p + 1).0[p]
            })
            .collect();
        let n = steps.len() as f64;
        let mean = steps.iter().sum::<f64>() / n;
        let spread: f64 = steps.iter().map(|s| (s - mean).powi(2)).sum();
        let std = ((n - 1.0) / n * spread).sqrt();
        (std.is_finite() && with.is_finite()).then_some(Delay {
            delay,
            std,
            blocks: steps.len(),
            coefficients,
        })
    }
}
