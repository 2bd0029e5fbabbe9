//! A cell of a map as the bytes of a part, and of the array `map.npy`.

use crate::error::{Error, Result};
use crate::model::Regime;
use crate::model::map::Cell;

/// Bytes of a cell.
pub const BYTES: usize = 17;

/// Their fields, as numpy's `dtype` writes them. `regime` is 0 where the rig cannot be computed, 1 without
/// impacts, 2 for a pattern of `impacts` in `cycles`, 3 for chatter and 4 for an irregular motion; `cycles`
/// of a chatter that does not repeat is 0; `spectral_radius` is NaN where there is none.
pub const FIELDS: &str =
    "[('regime', '|u1'), ('impacts', '<u4'), ('cycles', '<u4'), ('spectral_radius', '<f8')]";

/// The bytes of a cell.
pub fn packed(cell: &Cell) -> [u8; BYTES] {
    let (regime, impacts, cycles): (u8, u32, u32) = match cell.regime {
        None => (0, 0, 0),
        Some(Regime::NoImpact) => (1, 0, 0),
        Some(Regime::Periodic { impacts, cycles }) => (2, impacts, cycles),
        Some(Regime::Chatter { cycles }) => (3, 0, cycles.unwrap_or(0)),
        Some(Regime::Irregular) => (4, 0, 0),
    };
    let mut bytes = [0; BYTES];
    bytes[0] = regime;
    bytes[1..5].copy_from_slice(&impacts.to_le_bytes());
    bytes[5..9].copy_from_slice(&cycles.to_le_bytes());
    bytes[9..].copy_from_slice(&cell.spectral_radius.unwrap_or(f64::NAN).to_le_bytes());
    bytes
}

/// The cell of these bytes.
///
/// # Errors
/// If they are not those of a cell.
pub fn unpacked(bytes: &[u8]) -> Result<Cell> {
    let strange = || Error::refused("a cell of the part is none of a map");
    let bytes: &[u8; BYTES] = bytes.try_into().map_err(|_| strange())?;
    let [impacts, cycles] =
        [1, 5].map(|i| u32::from_le_bytes([bytes[i], bytes[i + 1], bytes[i + 2], bytes[i + 3]]));
    let regime = match bytes[0] {
        0 => None,
        1 => Some(Regime::NoImpact),
        2 => Some(Regime::Periodic { impacts, cycles }),
        3 => Some(Regime::Chatter { cycles: (cycles > 0).then_some(cycles) }),
        4 => Some(Regime::Irregular),
        _ => return Err(strange()),
    };
    let mut radius = [0; 8];
    radius.copy_from_slice(&bytes[9..]);
    let radius = f64::from_le_bytes(radius);
    Ok(Cell { regime, spectral_radius: (!radius.is_nan()).then_some(radius) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cell_comes_back_as_it_was() {
        let regimes = [
            None,
            Some(Regime::NoImpact),
            Some(Regime::Periodic { impacts: 3, cycles: 70_000 }),
            Some(Regime::Chatter { cycles: None }),
            Some(Regime::Chatter { cycles: Some(2) }),
            Some(Regime::Irregular),
        ];
        for regime in regimes {
            for spectral_radius in [None, Some(0.0), Some(f64::MIN_POSITIVE), Some(1.5)] {
                let cell = Cell { regime, spectral_radius };
                assert_eq!(unpacked(&packed(&cell)).unwrap(), cell);
            }
        }
        assert!(unpacked(&[5; BYTES]).is_err());
        assert!(unpacked(&[2; 16]).is_err());
    }
}
