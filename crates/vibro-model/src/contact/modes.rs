//! The linear modes of a rig: apart, in a contact of spring and damper, or moving together.

use crate::law::Law;
use crate::linear::{Linear, Quantity};
use crate::rig::Rig;
use crate::scene::Buffer;

/// All linear modes of a rig, each without and with the spring and damper of mass 1 acting.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Modes {
    /// Masses apart. In this array and the next two, index 1 is with the spring of mass 1 acting.
    pub apart: [Linear; 2],
    /// In contact through a spring and a damper.
    pub pushing: [Linear; 2],
    /// Moving together.
    pub together: [Linear; 2],
    /// Indentation δ = x₁ − x₂ − Δ in m.
    pub indentation: Quantity,
    /// Force in N of the contact's spring and damper; negative where it would pull.
    pub contact_force: Quantity,
    /// Compression in m of the spring of mass 1; negative where mass 1 is loose.
    pub compression: Quantity,
    /// Reduced mass M in kg; m₁ where mass 2 is a wall.
    pub reduced_mass: f64,
}

impl Modes {
    /// Modes of `rig` (m₂ may be infinite) with a contact of spring and damper. Spring and damper of a loose
    /// mass 1 act only in compression, beyond the gap of its `buffer`; its damper may act always.
    pub fn new(rig: &Rig, law: Option<Law>, buffer: Option<Buffer>) -> Modes {
        let [first, second] = rig.bodies();
        let inverse = rig.masses().map(|mass| 1.0 / mass);
        let (k3, c3) = law.filter(Law::is_linear).map_or((0.0, 0.0), |law| (law.stiffness, law.damping));
        let gap = buffer.map_or(0.0, |b| b.gap);
        let own = |acting: bool| {
            let k1 = if acting { first.stiffness } else { 0.0 };
            let c1 = if acting || buffer.is_some_and(|b| b.damper_always) { first.damping } else { 0.0 };
            ([[-k1, -c1, 0.0, 0.0], [0.0, 0.0, -second.stiffness, -second.damping]], -k1 * gap)
        };
        // Modes with a spring k and a damper c between the masses.
        let free = |k: f64, c: f64| {
            [false, true].map(|acting| {
                let (own, preload) = own(acting);
                let push = [k, c, -k, -c];
                let with =
                    |i: usize, sign: f64| std::array::from_fn(|j| (own[i][j] + sign * push[j]) * inverse[i]);
                let constant = [(preload + k * rig.gap) * inverse[0], -k * rig.gap * inverse[1]];
                Linear::new([with(0, -1.0), with(1, 1.0)], constant, [inverse[0], 0.0])
            })
        };
        let together = [false, true].map(|acting| {
            let (own, preload) = own(acting);
            let total = 1.0 / rig.masses().iter().sum::<f64>();
            let both = std::array::from_fn(|j| (own[0][j] + own[1][j]) * total);
            Linear::new([both, both], [preload * total; 2], [total; 2])
        });
        Modes {
            apart: free(0.0, 0.0),
            pushing: free(k3, c3),
            together,
            indentation: Quantity { weights: [1.0, 0.0, -1.0, 0.0], force: 0.0, offset: -rig.gap },
            contact_force: Quantity { weights: [k3, c3, -k3, -c3], force: 0.0, offset: -k3 * rig.gap },
            compression: Quantity { weights: [-1.0, 0.0, 0.0, 0.0], force: 0.0, offset: -gap },
            reduced_mass: rig.reduced_mass(),
        }
    }

    /// Contact force in N that would keep the masses together: M(a₁ − a₂), with the acceleration of each mass
    /// alone.
    #[inline]
    pub fn pressing(&self, spring_acts: bool) -> Quantity {
        self.apart[usize::from(spring_acts)].closing().times(self.reduced_mass)
    }
}
