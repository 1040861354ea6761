//! F5: the bus that supplies all drivers.

use super::parameters::Plant;

/// Source, buffer and bus.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Supply {
    supply_v: f64,
    source_ohm: f64,
    /// Cb, F.
    buffer: Option<f64>,
    source_sinks: bool,
    /// A.
    pub(super) idle: f64,
    /// V.
    pub(super) v: f64,
}

impl Supply {
    /// At cycle 0, with a power of `p` watts in the windings.
    pub(super) fn new(plant: &Plant, supply_v: f64, motors: usize, p: f64) -> Self {
        let idle = plant.idle_ma / 1000.0 * motors as f64;
        let buffer = plant.buffer_uf.map(|uf| uf / 1e6);
        let v = if buffer.is_some() {
            let vi = supply_v - plant.source_ohm * idle;
            0.5 * (vi + (vi * vi - 4.0 * plant.source_ohm * p).sqrt())
        } else {
            supply_v
        };
        Self { supply_v, source_ohm: plant.source_ohm, buffer, source_sinks: plant.source_sinks, idle, v }
    }

    /// i_load of a grid step of `h` seconds, A.
    pub(super) fn load_current(&self, energies: &[f64], h: f64) -> f64 {
        let mut sum = 0.0;
        for energy in energies {
            sum += energy;
        }
        sum / (self.v * h) + self.idle
    }

    /// V after this step.
    pub(super) fn advance(&mut self, i_load: f64, h: f64) {
        let Some(capacitance) = self.buffer else {
            return;
        };
        let hc = h / capacitance;
        let gg = 0.5 * hc / self.source_ohm;
        let vm = (self.v + gg * self.supply_v - 0.5 * hc * i_load) / (1.0 + gg);
        let mut i_src = (self.supply_v - vm) / self.source_ohm;
        if i_src < 0.0 && !self.source_sinks {
            i_src = 0.0;
        }
        self.v += hc * (i_src - i_load);
        if self.v < self.supply_v / 16.0 {
            self.v = self.supply_v / 16.0;
        }
    }
}
