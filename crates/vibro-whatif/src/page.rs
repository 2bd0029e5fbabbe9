//! The functions by which a page calls the model. The page writes numbers at [`input`] and calls a
//! function, which returns a count. Then it reads that many numbers at [`output`].
#![allow(
    unsafe_code,
    reason = "a name by which a page calls a function is an unsafe attribute; nothing else is unsafe here"
)]

use super::Scene;
use std::sync::Mutex;
use vibro_model::Rig;

/// Parameters m1, m2, k1, k2, c1, c2, gap, restitution, force, stiffness in SI units, then arguments of the
/// function.
static INPUT: Mutex<[f64; 16]> = Mutex::new([0.0; 16]);
static OUTPUT: Mutex<Vec<f64>> = Mutex::new(Vec::new());

fn answered(answer: impl Fn(&Scene, &[f64; 16]) -> Vec<f64>) -> usize {
    let (Ok(input), Ok(mut output)) = (INPUT.lock(), OUTPUT.lock()) else { return 0 };
    let [m1, m2, k1, k2, c1, c2, gap, restitution, force, stiffness, ..] = *input;
    let scene = Scene { rig: Rig { m1, m2, k1, k2, c1, c2, gap, restitution }, force, stiffness };
    *output = answer(&scene, &input);
    output.len()
}

/// Address of 16 numbers: m1, m2, k1, k2, c1, c2, gap, restitution, force, stiffness in SI units; the
/// arguments of the function follow from index 10.
#[unsafe(no_mangle)]
pub extern "C" fn input() -> *mut f64 {
    INPUT.lock().map_or(std::ptr::null_mut(), |mut input| input.as_mut_ptr())
}

/// Address of the numbers of the last answer.
#[unsafe(no_mangle)]
pub extern "C" fn output() -> *const f64 {
    OUTPUT.lock().map_or(std::ptr::null(), |output| output.as_ptr())
}

/// Response at `input[12]` frequencies from `input[10]` to `input[11]` Hz: 8 numbers each, see
/// [`Scene::response`]. Returns the number of values in the output.
#[unsafe(no_mangle)]
pub extern "C" fn response() -> usize {
    answered(|scene, input| scene.response(input[10], input[11], input[12] as usize))
}

/// Settled motion from rest at `input[10]` Hz: 5 numbers a point, see [`Scene::motion`]. Returns the number
/// of values in the output.
#[unsafe(no_mangle)]
pub extern "C" fn motion() -> usize {
    answered(|scene, input| scene.motion(input[10]))
}
