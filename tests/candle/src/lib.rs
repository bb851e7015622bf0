//! A compensator on candle tensors: loads `compensator.safetensors` and predicts the residual torque of prepared
//! inputs, on any device that candle has.
//!
//! Written from `docs/compensator-format.md` alone and without the run-time's code, so that the two check each
//! other. For a control loop take `feedforward`: it is faster on single samples and allocates nothing.
//!
//! ```no_run
//! use candle_core::{DType, Device, Tensor};
//! use compensator_candle::Compensator;
//!
//! # fn main() -> candle_core::Result<()> {
//! let device = Device::Cpu;
//! let compensator = Compensator::load("model/compensator.safetensors", DType::F32, &device)?;
//! println!("{:?} to {:?}", compensator.inputs(), compensator.joints());
//! let inputs = Tensor::zeros((100, compensator.inputs().len()), DType::F32, &device)?;
//! let torque = compensator.torque(&inputs)?; // (100, joints), N·m
//! # Ok(())
//! # }
//! ```
#![forbid(unsafe_code)]

mod network;

use candle_core::{DType, Device, Result, Tensor, bail};
use network::{Architecture, Network};
use serde::Deserialize;
use sha2::{Digest, Sha256};
use std::collections::BTreeMap;
use std::path::Path;

#[derive(Deserialize)]
struct Envelope {
    format: String,
    version: u32,
    sha256: String,
    header: String,
}

#[derive(Deserialize)]
struct Header {
    joints: Vec<String>,
    inputs: Vec<String>,
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

/// The units of all joints, ready to predict.
pub struct Compensator {
    header: Header,
    tensors: BTreeMap<String, Tensor>,
    dtype: DType,
    device: Device,
}

impl Compensator {
    /// Reads a file; all computation is in `dtype` (F32 or F64) on `device`.
    ///
    /// # Errors
    /// Not a safetensors file, not a compensator of format 1, or one that was altered.
    pub fn load(path: impl AsRef<Path>, dtype: DType, device: &Device) -> Result<Self> {
        if !matches!(dtype, DType::F32 | DType::F64) {
            bail!("a compensator computes in F32 or F64, not {dtype:?}");
        }
        let bytes = std::fs::read(path)?;
        let Some((length, rest)) = bytes.split_first_chunk::<8>() else {
            bail!("shorter than a safetensors file");
        };
        let length = usize::try_from(u64::from_le_bytes(*length)).unwrap_or(usize::MAX);
        let Some(json) = rest.get(..length) else {
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
        let stored: BTreeMap<String, Tensor> =
            candle_core::safetensors::load_buffer(&bytes, &Device::Cpu)?
                .into_iter()
                .collect();
        if checksum(&envelope.header, &stored)? != envelope.sha256 {
            bail!("its checksum does not match: the file was altered or damaged");
        }
        let tensors = stored
            .into_iter()
            .map(|(name, tensor)| Ok((name, tensor.to_dtype(dtype)?.to_device(device)?)))
            .collect::<Result<_>>()?;
        Ok(Self {
            header: parse(envelope.header.as_bytes())?,
            tensors,
            dtype,
            device: device.clone(),
        })
    }

    /// Joints, base first: the columns of [`Self::torque`].
    pub fn joints(&self) -> &[String] {
        &self.header.joints
    }

    /// Names of the input columns, in their order.
    pub fn inputs(&self) -> &[String] {
        &self.header.inputs
    }

    /// Residual torque, N·m, after each row of `inputs` (samples, columns): one trajectory from its start, its
    /// samples at the period that the model was trained at. Shape (samples, joints).
    ///
    /// # Errors
    /// Inputs of another width, type or device; a tensor that is missing or of another shape than documented.
    pub fn torque(&self, inputs: &Tensor) -> Result<Tensor> {
        let (samples, columns) = inputs.dims2()?;
        if columns != self.header.inputs.len() {
            bail!(
                "{columns} input columns, the compensator takes {}",
                self.header.inputs.len()
            );
        }
        let silent = Tensor::zeros(samples, self.dtype, &self.device)?;
        let mut torque = vec![silent; self.header.joints.len()];
        for (i, unit) in self.header.units.iter().enumerate() {
            let Some(joint) = torque.get_mut(unit.joint) else {
                bail!(
                    "unit {i} is of joint {}, there are {}",
                    unit.joint,
                    self.header.joints.len()
                );
            };
            if unit.enabled && samples > 0 {
                *joint = (&*joint + self.unit(i, unit, inputs)?)?;
            }
        }
        Tensor::stack(&torque, 1)
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
        let columns = Tensor::new(unit.columns.as_slice(), &self.device)?;
        let x = scale(&table.index_select(&columns, 1)?, get("input")?)?;
        let range = get("range")?;
        let (low, high, mean) = (range.get(0)?, range.get(1)?, range.get(2)?);
        let span = (&high - &low)?;
        let slack = (&span * unit.fade.end)?;
        let held = x
            .broadcast_maximum(&(&low - &slack)?)?
            .broadcast_minimum(&(&high + &slack)?)?;
        let mut sum = Tensor::zeros(table.dim(0)?, self.dtype, &self.device)?;
        for member in 0..unit.members {
            let prefix = format!("units.{i}.members.{member}.");
            let network = Network {
                tensor: &|name| self.tensor(&format!("{prefix}{name}")),
            };
            sum = (sum + network.evaluate(&unit.architecture, &held)?)?;
        }
        let target = numbers(&get("target")?.flatten_all()?)?;
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

/// A vector's values on the host.
fn numbers(vector: &Tensor) -> Result<Vec<f64>> {
    vector.to_dtype(DType::F64)?.to_vec1()
}

/// The checksum of the format: header, then every tensor by ascending name.
fn checksum(header: &str, tensors: &BTreeMap<String, Tensor>) -> Result<String> {
    let mut hash = Sha256::new();
    hash.update(header);
    for (name, tensor) in tensors {
        hash.update([0]);
        hash.update(name);
        for size in tensor.dims() {
            hash.update([0]);
            hash.update(size.to_string());
        }
        hash.update([0]);
        for value in tensor.flatten_all()?.to_vec1::<f32>()? {
            hash.update(value.to_le_bytes());
        }
    }
    Ok(hash.finalize().iter().map(|b| format!("{b:02x}")).collect())
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
        let row = numbers(&factor.get(k)?)?;
        let mut rest = r.narrow(1, k, 1)?;
        for (z, l) in solved.iter().zip(&row) {
            rest = (rest - (z * *l)?)?;
        }
        solved.push((rest / row[k])?);
    }
    Tensor::cat(&solved, 1)?.sqr()?.sum(1)?.sqrt()
}
