use super::*;

#[test]
fn a_decay_is_taken_off_what_oscillates_and_decays_by_more() {
    let pole = |zeta| Pole { frequency: 100.0 / TAU, zeta, constant: Complex64::new(1.0, 0.0) };
    // s = −10 ± 100i√0.99 without 4 is −6 ± 100i√0.99.
    let own = pole(0.1).without_decay(4.0, 0).unwrap();
    let expected = 36f64 + 9900.0;
    assert!((TAU * own.frequency / expected.sqrt() - 1.0).abs() < 1e-12);
    assert!((own.zeta / (6.0 / expected.sqrt()) - 1.0).abs() < 1e-12);
    assert!(pole(0.1).without_decay(11.0, 0).is_none());
    assert!([1.0, 1.5, f64::NAN].iter().all(|zeta| pole(*zeta).without_decay(0.0, 2).is_none()));
}
