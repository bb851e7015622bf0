//! Storage: one safetensors file, described in `docs/compensator-format.md`.

use std::io::Write;
use std::path::Path;

use safetensors::SafeTensors;
use safetensors::tensor::{Dtype, TensorView};
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use super::{Architecture, Bounds, Compensator, Error, Fade, Normaliser, Unit, Weights};

/// Name of the format in the metadata.
pub const FORMAT: &str = "residyn/compensator";
/// Version that this build writes and reads.
pub const VERSION: u32 = 1;
/// Only metadata key: a second one would be written in an order that changes from run to run.
const KEY: &str = "residyn";

#[derive(Serialize, Deserialize)]
struct Envelope {
    format: String,
    version: u32,
    sha256: String,
    /// JSON of [`Header`], kept as a string so that the checksum covers its exact bytes.
    header: String,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Header {
    joints: Vec<String>,
    inputs: Vec<String>,
    units: Vec<UnitHeader>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct UnitHeader {
    joint: usize,
    enabled: bool,
    architecture: Architecture,
    columns: Vec<usize>,
    members: usize,
    radius: f32,
    limit: f32,
    fade: Fade,
    #[serde(default, skip_serializing_if = "Weights::is_f32")]
    weights: Weights,
}

/// A tensor in the form of the file.
struct Stored {
    name: String,
    shape: Vec<usize>,
    bytes: Vec<u8>,
}

impl Stored {
    fn new(name: String, shape: &[usize], values: &[&[f32]]) -> Self {
        let bytes = values
            .iter()
            .flat_map(|part| part.iter())
            .flat_map(|v| v.to_le_bytes())
            .collect();
        Self {
            name,
            shape: shape.to_vec(),
            bytes,
        }
    }
}

/// SHA-256, hexadecimal, over the header's bytes and then, by ascending name, each tensor's name, shape
/// (as decimal numbers) and bytes, all separated by a zero byte.
fn checksum<'a>(
    header: &str,
    tensors: impl Iterator<Item = (&'a str, &'a [usize], &'a [u8])>,
) -> String {
    let mut tensors: Vec<_> = tensors.collect();
    tensors.sort_by_key(|t| t.0);
    let mut hash = Sha256::new();
    hash.update(header);
    for (name, shape, bytes) in tensors {
        hash.update([0]);
        hash.update(name);
        for n in shape {
            hash.update([0]);
            hash.update(n.to_string());
        }
        hash.update([0]);
        hash.update(bytes);
    }
    hash.finalize().iter().map(|b| format!("{b:02x}")).collect()
}

impl Compensator {
    /// Content of the file. The same compensator gives the same bytes.
    ///
    /// # Errors
    /// [`Error::Unit`] where a unit contradicts itself.
    pub fn to_bytes(&self) -> Result<Vec<u8>, Error> {
        self.check()?;
        let mut stored = Vec::new();
        let mut units = Vec::new();
        for (i, u) in self.units.iter().enumerate() {
            let d = u.columns.len();
            let b = &u.bounds;
            stored.push(Stored::new(
                format!("units.{i}.input"),
                &[2, d],
                &[u.input.offset(), u.input.span()],
            ));
            stored.push(Stored::new(
                format!("units.{i}.target"),
                &[2, 1],
                &[u.target.offset(), u.target.span()],
            ));
            stored.push(Stored::new(
                format!("units.{i}.range"),
                &[3, d],
                &[b.low(), b.high(), b.mean()],
            ));
            stored.push(Stored::new(
                format!("units.{i}.covariance_factor"),
                &[d, d],
                &[b.factor()],
            ));
            let tensors = u.architecture.tensors(d).unwrap_or_default();
            for (m, parameters) in u.members.iter().enumerate() {
                for t in &tensors {
                    let name = format!("units.{i}.members.{m}.{}", t.name);
                    stored.push(Stored::new(name, &t.shape, &[&parameters[t.range.clone()]]));
                }
            }
            units.push(UnitHeader {
                joint: u.joint,
                enabled: u.enabled,
                architecture: u.architecture.clone(),
                columns: u.columns.clone(),
                members: u.members.len(),
                radius: b.radius(),
                limit: b.limit(),
                fade: b.fade(),
                weights: u.weights,
            });
        }
        let header = Header {
            joints: self.joints.clone(),
            inputs: self.inputs.clone(),
            units,
        };
        let header =
            serde_json::to_string(&header).map_err(|e| Error::NotACompensator(e.to_string()))?;
        let sha256 = checksum(
            &header,
            stored
                .iter()
                .map(|t| (&t.name[..], &t.shape[..], &t.bytes[..])),
        );
        let envelope = Envelope {
            format: FORMAT.into(),
            version: VERSION,
            sha256,
            header,
        };
        let envelope =
            serde_json::to_string(&envelope).map_err(|e| Error::NotACompensator(e.to_string()))?;
        let views = stored
            .iter()
            .map(|t| {
                Ok((
                    &t.name[..],
                    TensorView::new(Dtype::F32, t.shape.clone(), &t.bytes)?,
                ))
            })
            .collect::<Result<Vec<_>, Error>>()?;
        let metadata = [(KEY.to_owned(), envelope)].into_iter().collect();
        Ok(safetensors::serialize(views, Some(metadata))?)
    }

    /// The compensator from bytes of [`Self::to_bytes`].
    ///
    /// # Errors
    /// [`Error::Container`] where the file is cut short, [`Error::NotACompensator`], [`Error::Version`],
    /// [`Error::Checksum`] where a byte differs, [`Error::Unit`] where the content contradicts itself.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, Error> {
        let (_, metadata) = SafeTensors::read_metadata(bytes)?;
        let file = SafeTensors::deserialize(bytes)?;
        let envelope = metadata.metadata().as_ref().and_then(|m| m.get(KEY));
        let envelope =
            envelope.ok_or_else(|| Error::NotACompensator(format!("no metadata entry `{KEY}`")))?;
        let not_ours = |e: serde_json::Error| Error::NotACompensator(e.to_string());
        // The version comes first: another version may have another envelope.
        let Version { format, version } = serde_json::from_str(envelope).map_err(not_ours)?;
        if format != FORMAT {
            return Err(Error::NotACompensator(format!("its format is `{format}`")));
        }
        if version != VERSION {
            return Err(Error::Version {
                found: version,
                supported: VERSION,
            });
        }
        let envelope: Envelope = serde_json::from_str(envelope).map_err(not_ours)?;
        let tensors = file.tensors();
        let found = checksum(
            &envelope.header,
            tensors
                .iter()
                .map(|(name, t)| (&name[..], t.shape(), t.data())),
        );
        if found != envelope.sha256 {
            return Err(Error::Checksum {
                expected: envelope.sha256,
                found,
            });
        }
        let header: Header = serde_json::from_str(&envelope.header).map_err(not_ours)?;
        let units = header
            .units
            .iter()
            .enumerate()
            .map(|(i, u)| {
                read_unit(&file, i, u).map_err(|problem| Error::Unit { unit: i, problem })
            })
            .collect::<Result<_, _>>()?;
        let compensator = Self {
            joints: header.joints,
            inputs: header.inputs,
            units,
        };
        compensator.check()?;
        Ok(compensator)
    }

    /// Writes the file under a temporary name beside `path`, then renames it.
    ///
    /// # Errors
    /// [`Error::Io`], and as [`Self::to_bytes`].
    pub fn save(&self, path: &Path) -> Result<(), Error> {
        let bytes = self.to_bytes()?;
        let mut temporary = path.as_os_str().to_owned();
        temporary.push(".tmp");
        let temporary = Path::new(&temporary);
        let written = std::fs::File::create(temporary)
            .and_then(|mut f| f.write_all(&bytes).and_then(|()| f.sync_all()))
            .and_then(|()| std::fs::rename(temporary, path));
        written.map_err(|source| {
            // Best effort: the error at hand says more than a failed clean-up would.
            let _ = std::fs::remove_file(temporary);
            Error::Io {
                path: path.to_owned(),
                source,
            }
        })
    }

    /// Reads a file written by [`Self::save`].
    ///
    /// # Errors
    /// [`Error::Io`], and as [`Self::from_bytes`].
    pub fn load(path: &Path) -> Result<Self, Error> {
        let bytes = std::fs::read(path).map_err(|source| Error::Io {
            path: path.to_owned(),
            source,
        })?;
        Self::from_bytes(&bytes)
    }
}

#[derive(Deserialize)]
struct Version {
    format: String,
    version: u32,
}

fn read_tensor(file: &SafeTensors, name: &str, shape: &[usize]) -> Result<Vec<f32>, String> {
    let view = file
        .tensor(name)
        .map_err(|e| format!("tensor `{name}`: {e}"))?;
    if view.dtype() != Dtype::F32 || view.shape() != shape {
        return Err(format!(
            "tensor `{name}` is {:?} {:?}, expected F32 {shape:?}",
            view.dtype(),
            view.shape()
        ));
    }
    let (values, _) = view.data().as_chunks::<4>();
    Ok(values.iter().map(|b| f32::from_le_bytes(*b)).collect())
}

fn read_unit(file: &SafeTensors, i: usize, u: &UnitHeader) -> Result<Unit, String> {
    let d = u.columns.len();
    let normaliser = |name: &str, columns| {
        let mut offset = read_tensor(file, name, &[2, columns])?;
        let span = offset.split_off(columns);
        Normaliser::new(offset, span).ok_or_else(|| format!("`{name}` is not a scaling"))
    };
    let input = normaliser(&format!("units.{i}.input"), d)?;
    let target = normaliser(&format!("units.{i}.target"), 1)?;
    let mut low = read_tensor(file, &format!("units.{i}.range"), &[3, d])?;
    let mut high = low.split_off(d);
    let mean = high.split_off(d);
    let factor = read_tensor(file, &format!("units.{i}.covariance_factor"), &[d, d])?;
    let bounds = Bounds::new(low, high, mean, factor, u.radius, u.limit, u.fade)
        .ok_or("its bounds are not usable")?;
    let tensors = u
        .architecture
        .tensors(d)
        .ok_or("a width of its architecture is zero or absurdly large")?;
    let members = (0..u.members)
        .map(|m| {
            let mut parameters = Vec::new();
            for t in &tensors {
                parameters.extend(read_tensor(
                    file,
                    &format!("units.{i}.members.{m}.{}", t.name),
                    &t.shape,
                )?);
            }
            Ok(parameters)
        })
        .collect::<Result<_, String>>()?;
    Ok(Unit {
        joint: u.joint,
        enabled: u.enabled,
        architecture: u.architecture.clone(),
        columns: u.columns.clone(),
        input,
        target,
        bounds,
        members,
        weights: u.weights,
    })
}

#[cfg(test)]
mod tests;
