//! The supply of all drivers of a plant: voltage and current (PLANT F5).

use crate::{parameters, root::square_root};

#[derive(Clone, Debug)]
pub(crate) struct Supply {
    /// Voltage at the drivers in V.
    pub(crate) voltage: f64,
    /// Current of the drivers in the last grid step, in A.
    pub(crate) current: f64,
    /// Idle current of all drivers in A.
    idle: f64,
    /// Grid step in s.
    h: f64,
    source_v: f64,
    source_ohm: f64,
    source_sinks: bool,
    /// The constants h/C and h/(2*C*R) of the buffer.
    buffer: Option<(f64, f64)>,
    pub(crate) has_collapsed: bool,
}

impl Supply {
    /// `None` if the source cannot supply the motors at the start.
    pub(crate) fn new(supply: &parameters::Supply, h: f64, motors: usize, first_power: f64) -> Option<Self> {
        let &parameters::Supply { supply_v: source_v, source_ohm, source_sinks, idle_ma, buffer_uf } = supply;
        let idle = idle_ma / 1000.0 * motors as f64;
        let buffer = buffer_uf.map(|uf| {
            let hc = h / (uf / 1e6);
            (hc, 0.5 * hc / source_ohm)
        });
        // With a buffer, the voltage is the one at which the source supplies exactly the power of the windings.
        let voltage = if buffer.is_some() {
            let v_i = source_v - source_ohm * idle;
            0.5 * (v_i + square_root(v_i * v_i - 4.0 * source_ohm * first_power))
        } else {
            source_v
        };
        let current = first_power / voltage + idle;
        let new = Self {
            voltage,
            current,
            idle,
            h,
            source_v,
            source_ohm,
            source_sinks,
            buffer,
            has_collapsed: false,
        };
        (!voltage.is_nan()).then_some(new)
    }

    /// Advances to the next point, after a grid step in which the motors took `energy` J; implicit midpoint rule.
    pub(crate) fn advance(&mut self, energy: f64) {
        self.current = energy / (self.voltage * self.h) + self.idle;
        let Some((hc, gg)) = self.buffer else { return };
        let v_m = (self.voltage + gg * self.source_v - 0.5 * hc * self.current) / (1.0 + gg);
        let mut i_source = (self.source_v - v_m) / self.source_ohm;
        if i_source < 0.0 && !self.source_sinks {
            i_source = 0.0;
        }
        self.voltage += hc * (i_source - self.current);
        let floor = self.source_v / 16.0;
        self.has_collapsed = self.voltage <= floor;
        if self.voltage < floor {
            self.voltage = floor;
        }
    }
}
