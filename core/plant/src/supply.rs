//! The bus that feeds all drivers of a plant: voltage and current (PLANT F5).

use crate::{parameters, root::square_root};

#[derive(Clone, Debug)]
pub(crate) struct Supply {
    /// Bus voltage in V.
    pub(crate) v: f64,
    /// Current of the drivers in the last grid step, in A.
    pub(crate) i_load: f64,
    /// Idle current of all drivers in A.
    idle: f64,
    /// Grid step in s.
    h: f64,
    supply_v: f64,
    source_ohm: f64,
    source_sinks: bool,
    /// The constants h/C and h/(2*C*R) of the buffer.
    buffer: Option<(f64, f64)>,
    pub(crate) has_collapsed: bool,
}

impl Supply {
    /// `None` if the source cannot supply the motors at the start.
    pub(crate) fn new(supply: &parameters::Supply, h: f64, motors: usize, first_power: f64) -> Option<Self> {
        let &parameters::Supply { supply_v, source_ohm, source_sinks, idle_ma, buffer_uf } = supply;
        let idle = idle_ma / 1000.0 * motors as f64;
        let buffer = buffer_uf.map(|uf| {
            let hc = h / (uf / 1e6);
            (hc, 0.5 * hc / source_ohm)
        });
        // With a buffer, the bus is where the source supplies exactly the power of the windings.
        let v = if buffer.is_some() {
            let v_i = supply_v - source_ohm * idle;
            0.5 * (v_i + square_root(v_i * v_i - 4.0 * source_ohm * first_power))
        } else {
            supply_v
        };
        let i_load = first_power / v + idle;
        let new =
            Self { v, i_load, idle, h, supply_v, source_ohm, source_sinks, buffer, has_collapsed: false };
        (!v.is_nan()).then_some(new)
    }

    /// Advances to the next point, after a grid step in which the motors took `energy` J; implicit midpoint rule.
    pub(crate) fn advance(&mut self, energy: f64) {
        self.i_load = energy / (self.v * self.h) + self.idle;
        let Some((hc, gg)) = self.buffer else { return };
        let v_m = (self.v + gg * self.supply_v - 0.5 * hc * self.i_load) / (1.0 + gg);
        let mut i_source = (self.supply_v - v_m) / self.source_ohm;
        if i_source < 0.0 && !self.source_sinks {
            i_source = 0.0;
        }
        self.v += hc * (i_source - self.i_load);
        let floor = self.supply_v / 16.0;
        self.has_collapsed = self.v <= floor;
        if self.v < floor {
            self.v = floor;
        }
    }
}
