//! The lens that a `recording.json` describes, in the usual spellings.
//!
//! Beside `fx`, `fy`, `cx`, `cy`, the `intrinsics` hold the name of a model and its coefficients: in a list, in OpenCV's
//! order, or by their names `k1` to `k6`, `p1`, `p2`. Both may also stand in an object `distortion`. A lidar's beams are
//! `beam_altitude_angles` and `beam_azimuth_angles`, as Ouster names them.

use std::fmt;
use std::sync::Arc;

use isolux::{Distortion, Intrinsics, Lens, LensError, SpinningLidar};
use serde_json::{Map, Value};

const MODEL: [&str; 4] = ["model", "distortion_model", "lens_model", "camera_model"];
const COEFFICIENTS: [&str; 7] =
    ["coeffs", "coefficients", "distortion", "distortion_coefficients", "distortion_coeffs", "D", "d"];
/// In OpenCV's order.
const NAMED: [&str; 8] = ["k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6"];
const ALTITUDES: &str = "beam_altitude_angles";
const AZIMUTHS: &str = "beam_azimuth_angles";

/// What a recording says of its lens.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LensDescription {
    /// The lens; a pinhole where its distortion cannot be used.
    pub lens: Option<Lens>,
    /// What was said and is not used.
    pub unused: Option<UnusedLens>,
}

/// Fields about a lens that are not used, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct UnusedLens {
    /// The fields of `recording.json`.
    pub fields: String,
    /// What is wrong with them.
    pub reason: UnusedReason,
}

/// Why fields about a lens are not used.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum UnusedReason {
    /// They do not make a lens of these images.
    Lens(LensError),
    /// Coefficients that several models have.
    NoModel,
}

impl fmt::Display for UnusedLens {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { fields, reason } = self;
        match reason {
            UnusedReason::Lens(error) => write!(f, "`{fields}` not used: {error}"),
            UnusedReason::NoModel => write!(
                f,
                "`{fields}` not used: they belong to a rational polynomial or to a fisheye, and no `model` says to which"
            ),
        }
    }
}

/// A field about a lens that cannot be used, which is an error.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BadLens {
    pub(crate) field: String,
    pub(crate) found: Value,
    pub(crate) expected: String,
}

impl BadLens {
    fn new(field: &str, found: &Value, expected: impl Into<String>) -> Self {
        Self { field: field.to_owned(), found: found.clone(), expected: expected.into() }
    }
}

/// The lens of `pinhole` and the fields beside it, or of the beams that stand among the other fields of a recording.
pub(crate) fn describe(
    pinhole: Option<(Intrinsics, &Map<String, Value>)>,
    other: &Map<String, Value>,
) -> Result<LensDescription, BadLens> {
    match pinhole {
        Some((pinhole, beside)) => distorted(pinhole, beside),
        None => Ok(LensDescription { lens: beams(other)?.map(Lens::Spinning), unused: None }),
    }
}

/// Beams, wherever they stand.
fn beams(other: &Map<String, Value>) -> Result<Option<Arc<SpinningLidar>>, BadLens> {
    let inner = |name: &str| other.get(name).and_then(Value::as_object);
    let places = [inner("intrinsics"), inner("beam_intrinsics"), Some(other)];
    let Some(fields) = places.into_iter().flatten().find(|fields| is_beams(fields)) else { return Ok(None) };
    let angles = |name: &str| match fields.get(name) {
        None | Some(Value::Null) => Ok(Vec::new()),
        Some(value) => numbers(value).ok_or_else(|| BadLens::new(name, value, "a list of degrees")),
    };
    let lidar = SpinningLidar::new(&angles(ALTITUDES)?, &angles(AZIMUTHS)?);
    let bad = |error: LensError| {
        let name = if matches!(error, LensError::AzimuthCount { .. }) { AZIMUTHS } else { ALTITUDES };
        BadLens::new(name, &fields.get(name).cloned().unwrap_or_default(), error.expected())
    };
    lidar.map(|lidar| Some(Arc::new(lidar))).map_err(bad)
}

/// True for an object that describes the beams of a lidar.
pub(crate) fn is_beams(fields: &Map<String, Value>) -> bool {
    fields.get(ALTITUDES).is_some_and(Value::is_array)
}

/// A pinhole and the distortion that is described beside it.
fn distorted(pinhole: Intrinsics, fields: &Map<String, Value>) -> Result<LensDescription, BadLens> {
    let plain = |unused| LensDescription { lens: Some(Lens::Pinhole(pinhole)), unused };
    let (place, fields) = match fields.get("distortion").and_then(Value::as_object) {
        Some(inner) => ("intrinsics.distortion", inner),
        None => ("intrinsics", fields),
    };
    let Coefficients { names, values } = coefficients(place, fields)?;
    let Some(model) = model(place, fields, &values)? else {
        return Ok(if values.iter().all(|value| *value == 0.0) {
            plain(None)
        } else {
            plain(Some(UnusedLens { fields: format!("{place}.{names}"), reason: UnusedReason::NoModel }))
        });
    };
    let values =
        if names.starts_with('k') || names.starts_with('p') { in_order(&model, values) } else { values };
    match Distortion::named(&model, &values) {
        Ok(None) => Ok(plain(None)),
        Ok(Some(distortion)) => {
            Ok(LensDescription { lens: Some(Lens::Distorted(pinhole, distortion)), unused: None })
        }
        Err(error @ LensError::UnknownModel { .. }) => {
            let fields = if names.is_empty() { format!("{place}.model") } else { format!("{place}.{names}") };
            Ok(plain(Some(UnusedLens { fields, reason: UnusedReason::Lens(error) })))
        }
        Err(error) => {
            let field = if names.is_empty() { place.to_owned() } else { format!("{place}.{names}") };
            Err(BadLens::new(&field, &values.into(), error.expected()))
        }
    }
}

/// Coefficients, and the fields that they stand in: `coeffs`, or `k1, k2`.
struct Coefficients {
    names: String,
    /// Of a list as they stand there; of names in OpenCV's order, eight of them.
    values: Vec<f64>,
}

fn coefficients(place: &str, fields: &Map<String, Value>) -> Result<Coefficients, BadLens> {
    let field = |name: &str| format!("{place}.{name}");
    let list = COEFFICIENTS.into_iter().find(|name| fields.get(*name).is_some_and(Value::is_array));
    if let Some(name) = list {
        let value = &fields[name];
        let values =
            numbers(value).ok_or_else(|| BadLens::new(&field(name), value, "a list of finite numbers"))?;
        return Ok(Coefficients { names: name.to_owned(), values });
    }
    let (mut names, mut values) = (Vec::new(), Vec::new());
    for name in NAMED {
        let value = fields.get(name).filter(|value| !value.is_null());
        let number = value
            .map(|value| value.as_f64().ok_or_else(|| BadLens::new(&field(name), value, "a finite number")));
        names.extend(number.is_some().then_some(name));
        values.push(number.transpose()?.unwrap_or(0.0));
    }
    if names.is_empty() {
        values.clear();
    }
    names.sort_unstable();
    Ok(Coefficients { names: names.join(", "), values })
}

/// The name of the model; where none is given, what the coefficients show: OpenCV's models, by their number or names.
fn model(place: &str, fields: &Map<String, Value>, values: &[f64]) -> Result<Option<String>, BadLens> {
    let named = MODEL.into_iter().chain(["distortion"]).find_map(|name| {
        let value = fields.get(name).filter(|value| !value.is_null() && !value.is_array())?;
        Some((name, value))
    });
    if let Some((name, value)) = named {
        let text = value.as_str().map(str::to_owned);
        let bad = || BadLens::new(&format!("{place}.{name}"), value, "the name of a distortion model");
        return text.map(Some).ok_or_else(bad);
    }
    let is_list = COEFFICIENTS.iter().any(|name| fields.get(*name).is_some_and(Value::is_array));
    let given = |name: &str| fields.get(name).is_some_and(|value| !value.is_null());
    let model = match values.len() {
        0 => None,
        4 | 5 => Some("brown_conrady"),
        _ if is_list => Some("rational"),
        _ if given("k5") || given("k6") => Some("rational"),
        // k1 to k4: a fisheye has them as well.
        _ if given("k4") => (given("p1") || given("p2")).then_some("rational"),
        _ => Some("brown_conrady"),
    };
    Ok(model.map(str::to_owned))
}

/// Named coefficients in the order of their model: a fisheye's k1 to k4 come first.
fn in_order(model: &str, values: Vec<f64>) -> Vec<f64> {
    let is_fisheye = Distortion::named(model, &[]).is_ok_and(|distortion| distortion.is_some());
    match values.as_slice() {
        &[k1, k2, p1, p2, k3, k4, k5, k6] if is_fisheye => vec![k1, k2, k3, k4, p1, p2, k5, k6],
        _ => values,
    }
}

fn numbers(value: &Value) -> Option<Vec<f64>> {
    value.as_array()?.iter().map(Value::as_f64).collect()
}
