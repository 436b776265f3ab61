//! How far the engine's `f32` may lie from the plain formulas.

use placegraph::features::Feature;

/// Largest difference of a value of `feature` from `plain`, for a scan whose longest range is `longest_m`.
///
/// Counts of beams are exact. Else five digits, and where a value is a difference of larger ones, six digits
/// of what those can be: of a length for lengths, of the whole for relations; of the largest sum of the
/// Fourier series, which c_k divides by k². Rounding shows on the scale of decades near 0.
pub fn bound(feature: &Feature, plain: f64, longest_m: f64) -> f64 {
    let of_the_whole = match (feature.unit, feature.book) {
        ("beams", _) => return 0.0,
        (_, Some("B6")) => 1e-3 / feature.parameter.unwrap().powi(2),
        ("decades", _) if plain.abs() < 1.0 => 0.01,
        ("m", _) => 1e-6 * longest_m,
        ("m2", _) => 1e-6 * longest_m * longest_m,
        _ => 1e-6,
    };
    1e-5 * plain.abs() + of_the_whole
}
