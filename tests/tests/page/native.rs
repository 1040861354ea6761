//! The core's results of a scenario, without a browser.

use anyhow::{Result, anyhow};
use crc::{CRC_32_ISO_HDLC, Crc};
use data_encoding::BASE64URL_NOPAD;
use stepscope_core::inspect::trace::stored_run::StoredRun;
use stepscope_core::{
    peripheral::trace::Digest,
    scenario::{
        Problem, Problems, Scenario,
        link::{self, LinkError},
        presets::Preset,
    },
    sim::Experiment,
};

/// A scenario and all its results.
pub(crate) struct Known {
    pub(crate) scenario: Scenario,
    pub(crate) experiment: Experiment,
    pub(crate) recording: StoredRun,
    /// 16 hexadecimal digits, as on the page.
    pub(crate) digest: String,
    /// The part after the `#`.
    pub(crate) link: String,
}

impl Known {
    /// The scenario of a JSON text; `{}` is the default motion.
    pub(crate) fn of(json: &str) -> Result<Self> {
        let scenario = Scenario::from_json(json).map_err(listed)?;
        let experiment = Experiment::new(&scenario).map_err(listed)?;
        let mut recording = StoredRun::default();
        experiment.run(&mut recording);
        recording.packets.finish();
        let digest = format!("{:016x}", recording.digest.value());
        let link = link::encode(&scenario)?;
        Ok(Self { scenario, experiment, recording, digest, link })
    }

    /// The digest of one controller of a scenario, 0 the first.
    pub(crate) fn digest_of(json: &str, controller: usize) -> Result<String> {
        let experiment = Experiment::from_json(json).map_err(listed)?;
        let mut digests = vec![Digest::default(); experiment.controllers()];
        experiment.run_each(&mut digests);
        let digest = digests.get(controller).ok_or_else(|| anyhow!("no controller {controller}"))?;
        Ok(format!("{:016x}", digest.value()))
    }

    pub(crate) fn preset(preset: &Preset) -> Result<Self> {
        Self::of(preset.json)
    }

    /// This number of cycles in s.
    pub(crate) fn seconds(&self, cycles: u64) -> f64 {
        cycles as f64 / f64::from(self.experiment.config().clock_hz())
    }
}

/// The link of a scenario, without a run.
pub(crate) fn link_of(json: &str) -> Result<String> {
    Ok(link::encode(&Scenario::from_json(json).map_err(listed)?)?)
}

/// The path of the field for the default motion's distance.
pub(crate) const DISTANCE: &str = "source.motion.axes[0].moves[0].cosine.distance";

/// The default motion with another distance in steps.
pub(crate) fn with_distance(steps: f64) -> String {
    format!(
        r#"{{"source":{{"motion":{{"axes":[{{"moves":[{{"cosine":{{"distance":{{"steps":{steps}}}}}}}]}}]}}}}}}"#
    )
}

/// All problems of a scenario, as `check` reports them in the page.
pub(crate) fn problems(json: &str) -> Vec<Problem> {
    Experiment::from_json(json).err().into_iter().flatten().collect()
}

/// Why a link does not open; an error if it opens.
pub(crate) fn refusal(fragment: &str) -> Result<String> {
    let refused = link::decode(fragment)
        .and_then(|scenario| Experiment::new(&scenario).map_err(LinkError::Scenario))
        .err();
    refused.map(|error| error.to_string()).ok_or_else(|| anyhow!("{fragment} opens"))
}

/// A link of format 1 with a valid CRC and any payload.
pub(crate) fn forged(codec: char, payload: &[u8]) -> String {
    let text = format!("1.{codec}.{}", BASE64URL_NOPAD.encode(payload));
    format!("c={text}.{:08x}", Crc::<u32>::new(&CRC_32_ISO_HDLC).checksum(text.as_bytes()))
}

fn listed(problems: Problems) -> anyhow::Error {
    anyhow!(problems)
}
