//! Hypotheses of a case: no effect, every mechanism at every place, pairs of them. Their modes are sought from draws of the generator,
//! those of the true effects also from the truth: what the search misses of a rival makes the observer better than any can be, never
//! worse.

use super::fit::{Point, Window};
use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use std::collections::BTreeMap;
use trials::cases::{EFFECTS, Kind, Mechanism, Origin, Witness, effect_index, frequencies};

/// Draws by which the chance of a mechanism's places is counted.
const DRAWS: usize = 120;
/// Most draws of a shape at one place.
const MOST: usize = 10;
/// Places that are refined in a part of the log, and in all of it.
const REFINED: [usize; 2] = [20, 6];
/// Mechanisms to which a second one is sought, and pairs that are refined in a part of the log, and in all of it.
const FIRSTS: usize = 3;
const PAIRS: [usize; 2] = [5, 2];
/// Steps of refinement in a part of the log, and in all of it.
const STEPS: [usize; 2] = [6, 4];

/// One hypothesis with its posterior weight.
pub struct Hypothesis {
    /// Mechanisms that act; none without effect.
    pub point: Point,
    /// Logarithm of prior times evidence, up to a constant of the case.
    pub weight: f64,
}

/// Name of what a function draws, as reports have it.
pub fn name_of(origin: Origin) -> &'static str {
    match origin {
        Origin::Listed(index) => EFFECTS[index],
        Origin::Worn(0) => "joint_elasticity",
        Origin::Worn(_) => "backlash",
        Origin::Outside => "unknown",
        Origin::AtRest => "external_contact",
    }
}

/// Functions that draw a single effect, with the logarithm of their part of all cases; the parts without and with two effects.
struct Priors {
    single: Vec<(Origin, f64)>,
    none: f64,
    two: f64,
    same_joint: bool,
}

impl Priors {
    fn new(hard: bool) -> Self {
        let mut made = Self {
            single: Vec::new(),
            none: f64::NEG_INFINITY,
            two: f64::NEG_INFINITY,
            same_joint: hard,
        };
        let gears = ["joint_elasticity", "backlash"].map(effect_index);
        for (kind, part) in frequencies(hard) {
            match kind {
                Kind::None => made.none = part.ln(),
                Kind::Outside => made.single.push((Origin::Outside, part.ln())),
                Kind::ContactAtRest => made.single.push((Origin::AtRest, part.ln())),
                Kind::Two | Kind::TwoOfOneJoint => made.two = part.ln(),
                Kind::Single(e) => {
                    let worn = gears.iter().position(|g| *g == Some(e)).filter(|_| hard);
                    let part = if worn.is_some() { 0.5 * part } else { part };
                    made.single.push((Origin::Listed(e), part.ln()));
                    made.single
                        .extend(worn.map(|w| (Origin::Worn(w), part.ln())));
                }
            }
        }
        made
    }

    /// Logarithm of the part of all cases that has these two effects; none where no case has both.
    fn pair(&self, [a, b]: [&Mechanism; 2]) -> Option<f64> {
        let listed = |m: &Mechanism| matches!(m.origin, Origin::Listed(_));
        if !listed(a) || !listed(b) || a.origin == b.origin {
            return None;
        }
        if self.same_joint {
            let of_gear = |m: &Mechanism| trials::cases::OF_A_GEAR.contains(&name_of(m.origin));
            let pairs = (trials::cases::OF_A_GEAR.len() * (trials::cases::OF_A_GEAR.len() - 1)) / 2;
            let may = of_gear(a) && of_gear(b) && a.joint == b.joint;
            return may.then(|| self.two - (pairs as f64).ln());
        }
        let pairs = (EFFECTS.len() * (EFFECTS.len() - 1)) / 2;
        Some(self.two - (pairs as f64).ln())
    }
}

/// One draw at a place, its torque in the part of the log, and the logarithm of its prior.
struct Scanned {
    point: Point,
    prior: f64,
    place: f64,
}

/// All hypotheses that a case leaves, in a `part` of its log and in the `whole`.
pub fn hypotheses(witness: &Witness, hard: bool, part: &Window, whole: &Window) -> Vec<Hypothesis> {
    let priors = Priors::new(hard);
    let mut rng = ChaCha8Rng::seed_from_u64(1);
    let mut scanned: Vec<Scanned> = Vec::new();
    for &(origin, prior) in &priors.single {
        scanned.extend(scan(witness, part, origin, prior, &mut rng));
    }
    let truth = truth(witness);
    let mut found = vec![Hypothesis {
        weight: priors.none - 0.5 * whole.rest.dot(&whole.rest),
        point: Point {
            parts: Vec::new(),
            misfit: whole.rest.dot(&whole.rest),
            torque: whole.rest.plus(-1.0, &whole.rest),
            volume: 0.0,
        },
    }];
    // The best of each place.
    scanned.sort_by(|a, b| a.point.misfit.total_cmp(&b.point.misfit));
    let mut best: Vec<(Point, f64)> = Vec::new();
    let mut places = Vec::new();
    let mut true_one = None;
    if let [(mechanism, _)] = &truth[..] {
        let own = priors.single.iter().find(|p| p.0 == mechanism.origin);
        let prior = own.map_or(f64::NEG_INFINITY, |p| p.1) + place(&scanned, mechanism);
        if let Some(point) = part.at(again(witness, &truth)) {
            true_one = Some((part.refined(point, STEPS[0]), prior));
        }
    }
    for s in &scanned {
        let (mechanism, _) = &s.point.parts[0];
        let key = (name_of(mechanism.origin), mechanism.joint);
        if places.contains(&key) || places.len() >= REFINED[0] {
            continue;
        }
        places.push(key);
        let Some(point) = part.at(again(witness, &s.point.parts)) else {
            continue;
        };
        best.push((part.refined(point, STEPS[0]), s.prior + s.place));
    }
    best.sort_by(|a, b| a.0.misfit.total_cmp(&b.0.misfit));
    let pairs = pairs(witness, &priors, part, &best, &scanned, &truth);
    let singles = true_one.iter().chain(best.iter().take(REFINED[1]));
    let chosen = singles.chain(&pairs);
    for (point, prior) in chosen {
        let Some(point) = whole.at(again(witness, &point.parts)) else {
            continue;
        };
        let point = whole.refined(point, STEPS[1]);
        let weight = prior + point.volume - 0.5 * point.misfit;
        // Of the modes at one place the likelier counts.
        match found.iter_mut().find(|h| is_places(&h.point, &point)) {
            Some(known) if known.weight >= weight => {}
            Some(known) => *known = Hypothesis { point, weight },
            None => found.push(Hypothesis { point, weight }),
        }
    }
    found
}

/// Whether two points have the same mechanisms at the same places.
fn is_places(a: &Point, b: &Point) -> bool {
    let own = |m: &Mechanism, of: &Point| of.parts.iter().any(|(o, _)| is_place(o, m));
    a.parts.len() == b.parts.len() && a.parts.iter().all(|(m, _)| own(m, b))
}

/// Draws of one function at each of its places.
fn scan(
    witness: &Witness,
    part: &Window,
    origin: Origin,
    prior: f64,
    rng: &mut ChaCha8Rng,
) -> Vec<Scanned> {
    let draws = (0..DRAWS).filter_map(|_| witness.mechanism(origin, &[], rng));
    let mut places: BTreeMap<Option<usize>, Vec<Mechanism>> = BTreeMap::new();
    for mechanism in draws {
        places.entry(mechanism.joint).or_default().push(mechanism);
    }
    let all: usize = places.values().map(Vec::len).sum();
    let mut found = Vec::new();
    for (_, draws) in places {
        let place = (draws.len() as f64 / all as f64).ln();
        let numbers = draws.first().map_or(0, |m| part.active(m).len());
        let told = draws
            .first()
            .is_some_and(|m| numbers == 0 && m.words.len() > 8);
        let most = if told { 1 } else { (1 + 2 * numbers).min(MOST) };
        let most = if origin == Origin::Outside {
            MOST
        } else {
            most
        };
        let points = draws.into_iter().take(most);
        found.extend(points.filter_map(|m| {
            Some(Scanned {
                point: part.sized(m, &part.rest)?,
                prior,
                place,
            })
        }));
    }
    found
}

/// The true mechanisms as drawn; none where one of them is not known.
fn truth(witness: &Witness) -> Parts {
    let mut rng = ChaCha8Rng::seed_from_u64(0);
    let own = witness.withheld.iter().map(|d| {
        let mechanism = witness.mechanism(d.origin, &d.words, &mut rng)?;
        Some((mechanism, d.size))
    });
    own.collect::<Option<Vec<_>>>().unwrap_or_default()
}

fn is_place(a: &Mechanism, b: &Mechanism) -> bool {
    a.origin == b.origin && a.joint == b.joint
}

/// The same mechanisms once more.
fn again(witness: &Witness, parts: &[(Mechanism, f64)]) -> Parts {
    let mut rng = ChaCha8Rng::seed_from_u64(0);
    let same = parts
        .iter()
        .filter_map(|(m, size)| Some((witness.mechanism(m.origin, &m.words, &mut rng)?, *size)));
    same.collect()
}

/// Mechanisms and their sizes.
type Parts = Vec<(Mechanism, f64)>;

/// Pairs of mechanisms: to each of the best single ones those that take most of what it leaves, and the true pair.
fn pairs(
    witness: &Witness,
    priors: &Priors,
    part: &Window,
    best: &[(Point, f64)],
    scanned: &[Scanned],
    truth: &[(Mechanism, f64)],
) -> Vec<(Point, f64)> {
    let mut tried: Vec<(f64, Parts, f64)> = Vec::new();
    for (first, _) in best.iter().take(FIRSTS) {
        let left = part.rest.plus(-1.0, &first.torque);
        for s in scanned {
            let [a, b] = [&first.parts[0].0, &s.point.parts[0].0];
            let Some(prior) = priors.pair([a, b]) else {
                continue;
            };
            let along = left.dot(&s.point.torque);
            let gain = along.max(0.0).powi(2) / s.point.torque.dot(&s.point.torque);
            let parts = again(witness, &first.parts).into_iter();
            let parts = parts.chain(again(witness, &s.point.parts)).collect();
            tried.push((
                first.misfit - gain,
                parts,
                prior + place(scanned, a) + s.place,
            ));
        }
    }
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    tried.truncate(PAIRS[0]);
    if let [(a, _), (b, _)] = truth
        && let Some(prior) = priors.pair([a, b])
    {
        let prior = prior + place(scanned, a) + place(scanned, b);
        tried.push((f64::NEG_INFINITY, again(witness, truth), prior));
    }
    let refined = tried.into_iter().filter_map(|(_, parts, prior)| {
        let point = part.at(parts)?;
        Some((part.refined(point, STEPS[0]), prior))
    });
    let mut refined: Vec<(Point, f64)> = refined.collect();
    // The true pair is the last.
    let true_pair = refined.pop_if(|_| truth.len() == 2);
    refined.sort_by(|a, b| a.0.misfit.total_cmp(&b.0.misfit));
    refined.truncate(PAIRS[1]);
    refined.extend(true_pair);
    refined
}

/// Logarithm of the chance of a mechanism's place; that of a place which none of the draws had is at most one draw's.
fn place(scanned: &[Scanned], mechanism: &Mechanism) -> f64 {
    let own = scanned
        .iter()
        .find(|s| is_place(&s.point.parts[0].0, mechanism));
    own.map_or(-(DRAWS as f64).ln(), |s| s.place)
}
