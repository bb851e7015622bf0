//! Evaluates compensator files as `docs/compensator-format.md` describes them, in double precision on
//! candle tensors. Shares no code with the run-time, so that the two check each other.
#![forbid(unsafe_code)]

mod network;

use candle_core::{DType, Device, Result, Tensor, bail};
use network::{Architecture, Network};
use serde::Deserialize;
use std::collections::HashMap;
use std::path::Path;

#[derive(Deserialize)]
struct Envelope {
    format: String,
    version: u32,
    header: String,
}

#[derive(Deserialize)]
struct Header {
    joints: Vec<String>,
    units: Vec<Unit>,
}

#[derive(Deserialize)]
struct Unit {
    joint: usize,
    enabled: bool,
    architecture: Architecture,
    columns: Vec<u32>,
    members: usize,
    radius: f64,
    limit: f64,
    fade: Fade,
}

#[derive(Clone, Copy, Deserialize)]
struct Fade {
    start: f64,
    end: f64,
}

/// A compensator file with its tensors.
pub struct Reader {
    header: Header,
    tensors: HashMap<String, Tensor>,
}

impl Reader {
    /// Reads a file; its checksum is not verified here.
    ///
    /// # Errors
    /// Not a safetensors file, or not one of format 1.
    pub fn load(path: &Path) -> Result<Self> {
        let bytes = std::fs::read(path)?;
        let Some((length, rest)) = bytes.split_first_chunk::<8>() else {
            bail!("shorter than a safetensors file");
        };
        let Some(json) = rest.get(..u64::from_le_bytes(*length) as usize) else {
            bail!("its header is cut short");
        };
        let outer: serde_json::Value = parse(json)?;
        let Some(envelope) = outer["__metadata__"]["residyn"].as_str() else {
            bail!("no metadata entry `residyn`");
        };
        let envelope: Envelope = parse(envelope.as_bytes())?;
        if (envelope.format.as_str(), envelope.version) != ("residyn/compensator", 1) {
            bail!("format {} {}", envelope.format, envelope.version);
        }
        let tensors = candle_core::safetensors::load_buffer(&bytes, &Device::Cpu)?
            .into_iter()
            .map(|(name, tensor)| Ok((name, tensor.to_dtype(DType::F64)?)))
            .collect::<Result<_>>()?;
        Ok(Self {
            header: parse(envelope.header.as_bytes())?,
            tensors,
        })
    }

    /// Residual torque, N·m, after each of `samples` (rows of all input columns), one trajectory from
    /// its start; shape (samples, joints).
    ///
    /// # Errors
    /// A tensor that is missing or of another shape than documented.
    pub fn torque(&self, samples: &[Vec<f32>]) -> Result<Vec<Vec<f64>>> {
        let mut torque = vec![vec![0.0; self.header.joints.len()]; samples.len()];
        let (rows, columns) = (samples.len(), samples.first().map_or(0, Vec::len));
        let table = Tensor::from_vec(samples.concat(), (rows, columns), &Device::Cpu)?
            .to_dtype(DType::F64)?;
        for (i, unit) in self.header.units.iter().enumerate() {
            if unit.enabled {
                let own = self.unit(i, unit, &table)?.to_vec1::<f64>()?;
                for (row, value) in torque.iter_mut().zip(own) {
                    row[unit.joint] += value;
                }
            }
        }
        Ok(torque)
    }

    fn tensor(&self, name: &str) -> Result<&Tensor> {
        match self.tensors.get(name) {
            Some(tensor) => Ok(tensor),
            None => bail!("no tensor `{name}`"),
        }
    }

    /// Torque of one unit after every row, shape (samples).
    fn unit(&self, i: usize, unit: &Unit, table: &Tensor) -> Result<Tensor> {
        let get = |name: &str| self.tensor(&format!("units.{i}.{name}"));
        let columns = Tensor::new(unit.columns.as_slice(), &Device::Cpu)?;
        let x = scale(&table.index_select(&columns, 1)?, get("input")?)?;
        let range = get("range")?;
        let (low, high, mean) = (range.get(0)?, range.get(1)?, range.get(2)?);
        let span = (&high - &low)?;
        let slack = (&span * unit.fade.end)?;
        let held = x
            .broadcast_maximum(&(&low - &slack)?)?
            .broadcast_minimum(&(&high + &slack)?)?;
        let mut sum = Tensor::zeros(table.dim(0)?, DType::F64, &Device::Cpu)?;
        for member in 0..unit.members {
            let prefix = format!("units.{i}.members.{member}.");
            let network = Network {
                tensor: &|name| self.tensor(&format!("{prefix}{name}")),
            };
            sum = (sum + network.evaluate(&unit.architecture, &held)?)?;
        }
        let target = get("target")?.flatten_all()?.to_vec1::<f64>()?;
        let torque = sum.affine(target[1] / unit.members as f64, target[0])?;
        let torque = bend(&torque, unit.limit)?;

        let beyond = x
            .broadcast_sub(&high)?
            .maximum(&x.broadcast_sub(&low)?.neg()?)?;
        // A column that never varied has no range to leave.
        let fixed = span.eq(0.0)?;
        let divisor = fixed.where_cond(&(span.ones_like()? * f64::INFINITY)?, &span)?;
        let excess = beyond.broadcast_div(&divisor)?;
        let mut weight = fade(
            &(distance(&x.broadcast_sub(&mean)?, get("covariance_factor")?)? / unit.radius)?
                .affine(1.0, -1.0)?,
            unit.fade,
        )?;
        for column in 0..unit.columns.len() {
            let own = excess.narrow(1, column, 1)?.squeeze(1)?;
            weight = (weight * fade(&own, unit.fade)?)?;
        }
        torque * weight
    }
}

fn parse<'a, T: Deserialize<'a>>(json: &'a [u8]) -> Result<T> {
    serde_json::from_slice(json).map_err(candle_core::Error::wrap)
}

/// (x − offset)/span, 0 where span is 0.
fn scale(x: &Tensor, scaling: &Tensor) -> Result<Tensor> {
    let (offset, span) = (scaling.get(0)?, scaling.get(1)?);
    let still = span.eq(0.0)?;
    let inverse = still.where_cond(&span.zeros_like()?, &span.recip()?)?;
    x.broadcast_sub(&offset)?.broadcast_mul(&inverse)
}

/// Above 90 % of the limit the torque bends towards it.
fn bend(torque: &Tensor, limit: f64) -> Result<Tensor> {
    let size = torque.abs()?;
    let bent = size
        .affine(1.0 / limit, -0.9)?
        .affine(10.0, 0.0)?
        .tanh()?
        .affine(0.1 * limit, 0.9 * limit)?;
    let size = size.gt(0.9 * limit)?.where_cond(&bent, &size)?;
    torque.sign()? * size
}

/// w(e) of the format.
fn fade(excess: &Tensor, fade: Fade) -> Result<Tensor> {
    let width = fade.end - fade.start;
    let s = excess
        .affine(1.0 / width, -fade.start / width)?
        .clamp(0.0, 1.0)?;
    let polynomial = ((s.sqr()? * 6.0)? - s.affine(15.0, -10.0)?)?;
    (s.powf(3.0)? * polynomial)?.affine(-1.0, 1.0)
}

/// ‖L⁻¹ r‖ of every row r, by forward substitution.
fn distance(r: &Tensor, factor: &Tensor) -> Result<Tensor> {
    let mut solved: Vec<Tensor> = Vec::new();
    for k in 0..factor.dim(0)? {
        let row = factor.get(k)?.to_vec1::<f64>()?;
        let mut rest = r.narrow(1, k, 1)?;
        for (z, l) in solved.iter().zip(&row) {
            rest = (rest - (z * *l)?)?;
        }
        solved.push((rest / row[k])?);
    }
    Tensor::cat(&solved, 1)?.sqr()?.sum(1)?.sqrt()
}
