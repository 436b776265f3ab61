//! Published-size values of two exact scans, for the engine and for the plain formulas alike.
#![expect(clippy::unreadable_literal, reason = "numbers as they are printed")]

use placegraph::features::{FeatureId, of_scan};
use placegraph::scan::RangeScan;
use placegraph_testkit::plain_features::{coefficient, decades, plain_feature, vertices};
use placegraph_testkit::scenes::{doorway, rectangle};

/// The plain formula gives `expected` to nine digits, the engine to `digits` of `f32`.
fn assert_feature(scan: &RangeScan, name: &str, expected: f64) {
    let id = FeatureId::from_name(name).unwrap();
    let plain = plain_feature(id.feature(), scan.ranges_m());
    let tolerance = |relative: f64| relative * expected.abs() + 1e-12;
    assert!((plain - expected).abs() <= tolerance(5e-9), "{name}: {plain}, expected {expected}");
    let engine = f64::from(of_scan(scan, &[id])[0]);
    assert!((engine - expected).abs() <= tolerance(1e-5), "engine's {name}: {engine}, expected {expected}");
}

#[test]
fn rectangle_set_a() {
    for (name, expected) in [
        ("A1", 0.029060635),
        ("A2", 0.0397842679),
        ("A3(1)", 0.0),
        ("A3(2)", 0.007158583),
        ("A3(3)", 0.0137022635),
        ("A5", 2.40743148),
        ("A6", 1.35763747),
        ("A7(0.5)", 0.0),
        ("A11", 0.989002446),
        ("A12", 0.0102614149),
        ("A13", 0.432757017),
        ("A14", 0.244047295),
        ("A15(0.9)", 0.0),
        ("A16", 2.74650417),
    ] {
        assert_feature(&rectangle(), name, expected);
    }
}

#[test]
fn rectangle_set_b() {
    for (name, expected) in [
        ("B1", 23.9932995),
        ("B2", 19.8818288),
        ("B4", 2.86642862),
        ("B5", 0.456693994),
        ("B6(3)", 0.0517902451),
        ("B6(5)", 0.0289866921),
        ("B7", 3.27246237),
        ("B8", 2.38007242),
        ("B9", 0.72730322),
        ("B11", 0.00961759702),
        ("B12", 0.282578179),
        ("B13", 67.6194562),
        ("B14", 16.4748961),
        ("B15", 0.762758717),
        ("B16", 0.797256779),
        ("B17", 0.127023007),
        ("f17_2", 1.157874296),
        ("f18_2", 0.842125704),
        ("f19_2", 0.72730322),
    ] {
        assert_feature(&rectangle(), name, expected);
    }
}

#[test]
fn rectangle_moment_invariants_in_decades() {
    for (name, phi) in [
        ("B10(1)", 1.48529731e-7),
        ("B10(2)", 1.76158675e-15),
        ("B10(3)", 1.64638554e-19),
        ("B10(4)", 3.39641936e-19),
        ("B10(6)", 1.42536965e-26),
    ] {
        assert_feature(&rectangle(), name, decades(phi));
    }
}

#[test]
fn rectangle_small_descriptors() {
    // Small against the sum they come from: the engine's error is relative to that.
    for (name, expected) in [("B6(2)", 0.00150179866), ("B6(100)", 4.34980613e-5)] {
        let id = FeatureId::from_name(name).unwrap();
        assert!(
            (plain_feature(id.feature(), rectangle().ranges_m()) - expected).abs() < 1e-8 * expected + 1e-13
        );
        assert!((f64::from(of_scan(&rectangle(), &[id])[0]) - expected).abs() < 1e-6);
    }
}

#[test]
fn doorway_both_sets() {
    for (name, expected) in [
        ("A7(0.5)", 4.0),
        ("A7(1)", 4.0),
        ("A7(1.5)", 4.0),
        ("A7(2)", 0.0),
        ("A15(0.2)", 0.0),
        ("A15(0.3)", 4.0),
        ("A15(0.9)", 4.0),
        ("A9", 0.9),
        ("A10", 180.0),
        ("A1", 0.0505389297),
        ("A2", 0.167442041),
        ("A5", 2.87627691),
        ("A6", 1.27673823),
        ("A11", 0.981225992),
        ("A13", 0.62595171),
        ("A16", 2.31660407),
        ("B1", 31.061655),
        ("B2", 29.2334919),
        ("B7", 3.86760032),
        ("B8", 2.09376963),
        ("B12", 0.458659107),
        ("B15", 0.456744228),
    ] {
        assert_feature(&doorway(), name, expected);
    }
}

#[test]
fn closed_form_of_the_fourier_coefficients_equals_the_integral() {
    // c_k = 1/L ∮ z(t) exp(−2πikt/L) dt, by the midpoint rule over the edges.
    let vertices = vertices(doorway().ranges_m());
    let n = vertices.len();
    let edges = (0..n).map(|i| (vertices[i], vertices[(i + 1) % n]));
    let length: f64 = edges.clone().map(|(p, q)| p.distance(q)).sum();
    for k in [-1, 1, 2, 7] {
        let (mut re, mut im, mut start) = (0.0, 0.0, 0.0);
        for (p, q) in edges.clone() {
            let n_parts = 400;
            for part in 0..n_parts {
                let along = (part as f64 + 0.5) / n_parts as f64;
                let z = p + (q - p) * along;
                let phase = -std::f64::consts::TAU * k as f64 * (start + along * p.distance(q)) / length;
                let weight = p.distance(q) / n_parts as f64 / length;
                re += weight * (z.x * phase.cos() - z.y * phase.sin());
                im += weight * (z.x * phase.sin() + z.y * phase.cos());
            }
            start += p.distance(q);
        }
        let c = coefficient(&vertices, k);
        assert!((c.x - re).hypot(c.y - im) < 1e-6, "k = {k}");
    }
}
