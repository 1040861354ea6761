//! The commands of each controller and how the host sends them (DESIGN A9).

use crate::hosts::framed_host::{FramedHost, Job};
use crate::line::{bus_load::carries, noise::Noise};
use alloc::{format, string::String, sync::Arc, vec, vec::Vec};
use stepscope_motion::step_tables::{AxesPath, exact_segments, ticks};
use stepscope_motion::{AxisList, AxisPlan, plan_lists};
use stepscope_peripheral::config::{Config, Protocol};
use stepscope_peripheral::segment::{CheckedSegments, PulseTimes};
use stepscope_peripheral::wire::frame::{ACK_LEN, encode_frame};
use stepscope_peripheral::wire::packet::{ChannelCommand, MAX_STEPS, Tick};
use stepscope_peripheral::wire::schedule::line_time;
use stepscope_peripheral::wire::{ForcedLevel, Schedule};
use stepscope_peripheral::{signal::MAX_CHANNELS, units::Instant};
use stepscope_scenario::{
    CheckedScenario, Controller, Hex, MAX_CONTROLLERS, Problem, Problems, Scenario, Source, ValueError,
    of_motion,
};

/// Maximum bytes of all controllers' ticks together.
const MAX_BYTES: usize = 8_000_000;
/// Bit times of an exchange besides its bytes: the turnaround before the reply, and the pause after it.
const EXCHANGE_BITS: u128 = 11 + 10;
/// Loads are counted in thousandths of a bit time.
const PART_OF_BIT: u128 = 1000;

#[derive(Clone, Debug)]
pub(super) struct ControllerPlan {
    config: Config,
    plans: Vec<AxisPlan>,
    /// One byte per channel, tick after tick.
    ticks: Arc<[u8]>,
}

impl ControllerPlan {
    pub(super) const fn config(&self) -> &Config {
        &self.config
    }

    pub(super) fn plans(&self) -> &[AxisPlan] {
        &self.plans
    }

    pub(super) fn ticks(&self) -> &[u8] {
        &self.ticks
    }

    pub(super) fn shared_ticks(&self) -> Arc<[u8]> {
        Arc::clone(&self.ticks)
    }

    pub(super) fn has_ticks(&self) -> bool {
        !self.ticks.is_empty()
    }

    pub(super) fn each_tick(&self) -> impl ExactSizeIterator<Item = &[u8]> {
        self.ticks.chunks(usize::from(self.config.channels()))
    }
}

/// The plan of each axis of each controller; empty if the source is not a motion.
pub(super) fn plans(scenario: &Scenario) -> Result<Vec<Vec<AxisPlan>>, Problems> {
    let Source::Motion(motion) = &scenario.source else {
        return Ok(vec![Vec::new(); 1 + scenario.controllers.len()]);
    };
    let additional = scenario.controllers.iter().take(MAX_CONTROLLERS - 1).enumerate();
    let additional = additional.map(|(index, one)| AxisList {
        path: format!("controllers[{index}].axes"),
        axes: &one.axes,
        groups: &[],
    });
    plan_lists([motion.axis_list()].into_iter().chain(additional)).map_err(of_motion)
}

pub(super) fn controller_plans(
    checked: &CheckedScenario,
    plans: Vec<Vec<AxisPlan>>,
) -> Result<Vec<ControllerPlan>, Problems> {
    let (mut controllers, mut problems, mut total) = (Vec::new(), Vec::new(), 0);
    for (index, (config, plans)) in checked.configs.iter().zip(plans).enumerate() {
        match ticks_of(checked, index, config, &plans) {
            Ok(mut ticks) => {
                total += ticks.len();
                if config.protocol() == Protocol::Framed {
                    end_without_steps(&mut ticks, config.channels());
                }
                debug_assert!(
                    ticks.len().is_multiple_of(config.channels().into()),
                    "a tick has one byte per channel"
                );
                controllers.push(ControllerPlan { config: config.clone(), plans, ticks: ticks.into() });
            }
            Err(found) => problems.extend(found),
        }
        if total > MAX_BYTES {
            let cause = ValueError::TooMuch {
                given: total as f64,
                max: MAX_BYTES as f64,
                of: "commands of all channels",
            };
            problems.push(Problem::new("controllers", cause));
            break;
        }
    }
    Problems::check(problems).map(|()| controllers)
}

fn additional_path(index: usize) -> Option<String> {
    index.checked_sub(1).map(|index| format!("controllers[{index}].axes"))
}

fn ticks_of(
    checked: &CheckedScenario,
    index: usize,
    config: &Config,
    plans: &[AxisPlan],
) -> Result<Vec<u8>, Problems> {
    let additional = index.checked_sub(1).and_then(|index| checked.additional.get(index));
    Ok(match &checked.source {
        source if !source.sends_ticks() => Vec::new(),
        Source::Motion(_) if plans.is_empty() => Vec::new(),
        Source::Motion(_) => {
            let tick = config.tick().0;
            let own = additional_path(index);
            let at = own.as_deref().map_or(AxesPath::MOTION, |axes| AxesPath { axes, whole: axes });
            let ticks = ticks(plans, at, config.channels(), config.slots(), tick, config.clock_hz());
            ticks.map_err(of_motion)?.bytes().to_vec()
        }
        Source::Packets(source) => {
            let packets = additional.map_or(&source.packets, |additional| &additional.packets);
            let address = usize::from(config.packet_address().is_some());
            packets.iter().flat_map(|packet| packet.0.iter().copied().skip(address)).collect()
        }
        _ => Vec::new(),
    })
}

pub(super) fn segments(
    checked: &CheckedScenario,
    controllers: &[ControllerPlan],
) -> Result<Option<CheckedSegments>, Problems> {
    match (&checked.source, controllers.first()) {
        (Source::Motion(_), Some(ControllerPlan { config, plans, .. })) if checked.source.uses_segments() => {
            let pulse = PulseTimes::from(config);
            let lists = exact_segments(plans, AxesPath::MOTION, config.channels(), pulse, config.clock_hz());
            lists.map(Some).map_err(of_motion)
        }
        _ => Ok(checked.segments.clone()),
    }
}

/// Appends a tick without steps, so that the end of a framed job is not an underrun.
fn end_without_steps(ticks: &mut Vec<u8>, channels: u8) {
    let last = ticks.chunks(usize::from(channels)).last();
    if let Some(last) = last.filter(|last| last.iter().any(|&byte| ChannelCommand::parse(byte).steps > 0)) {
        let directions: Vec<u8> = last.iter().map(|byte| byte & !MAX_STEPS).collect();
        ticks.extend(directions);
    }
}

/// What the host sends without waiting for replies, and the levels that noise forces.
pub(super) fn schedule(
    checked: &CheckedScenario,
    controllers: &[ControllerPlan],
) -> (Schedule, Vec<ForcedLevel>) {
    let schedule = match &checked.source {
        Source::Line(script) => script.schedule(),
        _ if checked.waits_for_replies() => return (Schedule::default(), Vec::new()),
        _ => paced(checked, controllers),
    };
    let clock_hz = controllers.first().map_or(1, |first| first.config.clock_hz());
    match Noise::new(&checked.noise, clock_hz, checked.baud) {
        Some(noise) => noise.schedule(&schedule),
        None => (schedule, Vec::new()),
    }
}

fn start(checked: &CheckedScenario) -> Instant {
    checked.configs.iter().map(|config| config.boot()).max().unwrap_or(Instant::RESET).next()
}

/// Packet j of all controllers in ascending address, back to back from start + j*M*Ts.
fn paced(checked: &CheckedScenario, controllers: &[ControllerPlan]) -> Schedule {
    let mut by_address: Vec<Packets<'_>> = Vec::new();
    for (index, plan) in controllers.iter().enumerate() {
        let packets = Packets::of(checked, index, plan);
        let address = plan.config.address();
        by_address
            .insert(by_address.partition_point(|before| before.plan.config.address() <= address), packets);
    }
    let count = by_address.iter().map(Packets::count).max().unwrap_or(0);
    let Some(first) = checked.configs.first() else { return Schedule::default() };
    let sends = (0..count).map(|tick| {
        let mut bytes = Vec::with_capacity(by_address.len() * (1 + MAX_CHANNELS));
        by_address.iter().for_each(|packets| packets.append(tick, &mut bytes));
        bytes
    });
    Schedule::paced(start(checked), first.tick(), sends)
}

/// The packets of a controller: from the scenario, or one per tick of its plan.
struct Packets<'a> {
    plan: &'a ControllerPlan,
    given: Option<&'a [Hex]>,
}

impl<'a> Packets<'a> {
    fn of(checked: &'a CheckedScenario, index: usize, plan: &'a ControllerPlan) -> Self {
        let additional = index.checked_sub(1).and_then(|index| checked.additional.get(index));
        let given = match &checked.source {
            Source::Packets(source) => {
                Some(&additional.map_or(&source.packets, |additional| &additional.packets)[..])
            }
            _ => None,
        };
        Self { plan, given }
    }

    fn count(&self) -> usize {
        self.given.map_or_else(|| self.plan.each_tick().len(), <[Hex]>::len)
    }

    fn append(&self, index: usize, bytes: &mut Vec<u8>) {
        if let Some(given) = self.given {
            bytes.extend_from_slice(given.get(index).map_or(&[], |packet| &packet.0));
            return;
        }
        let width = usize::from(self.plan.config.channels());
        if let Some(tick) = self.plan.ticks.get(index * width..(index + 1) * width) {
            bytes.extend(self.plan.config.packet_address());
            bytes.extend_from_slice(tick);
        }
    }
}

pub(super) fn jobs(controllers: &[ControllerPlan]) -> Vec<Job> {
    let with_ticks = controllers.iter().filter(|plan| plan.has_ticks());
    with_ticks.map(|plan| job(&plan.config, &plan.ticks)).collect()
}

pub(super) fn framed_host(checked: &CheckedScenario, controllers: &[ControllerPlan]) -> FramedHost {
    let (clock_hz, baud) = (controllers.first().map_or(1, |first| first.config.clock_hz()), checked.baud);
    let noise = Noise::new(&checked.noise, clock_hz, baud);
    let start = start(checked);
    FramedHost::new(
        jobs(controllers),
        &checked.host,
        (clock_hz, baud, Config::bit_of(clock_hz, baud)),
        start,
        noise,
    )
}

pub(super) fn job(config: &Config, ticks: &Arc<[u8]>) -> Job {
    Job {
        address: config.address().unwrap_or(0),
        channels: config.channels(),
        tick: config.tick(),
        queue_depth: config.queue_depth(),
        commands: Arc::clone(ticks),
    }
}

/// The line's load while all controllers move, 0 to 1; `None` without ticks. Errors: above 1, with the required rate.
pub(super) fn line_load<'a>(checked: &'a CheckedScenario) -> Result<Option<f64>, Problem> {
    let Some(first) = checked.configs.first() else { return Ok(None) };
    if !checked.source.sends_ticks() {
        return Ok(None);
    }
    let (clock_hz, tick) = (first.clock_hz(), first.tick().0);
    let busy = |(index, config): (usize, &'a Config)| {
        let additional = index.checked_sub(1).and_then(|index| checked.additional.get(index));
        additional.is_none_or(Controller::is_busy).then_some(config)
    };
    let configs = checked.configs.iter().enumerate().filter_map(busy);
    let (cycles, bits) = if checked.waits_for_replies() {
        // In ticks of the first controller, because ticks may differ in length.
        let bits: u128 = configs
            .map(|config| frame_bits(checked, config) * u128::from(tick) / u128::from(config.tick().0))
            .sum();
        let cycles = bits * u128::from(clock_hz) / (PART_OF_BIT * u128::from(checked.baud));
        (cycles, bits.div_ceil(PART_OF_BIT))
    } else {
        let bytes = configs.map(|config| config.packet_len() as u64).sum();
        (line_time(bytes, clock_hz, checked.baud).into(), u128::from(10 * bytes))
    };
    carries(cycles, bits, tick, clock_hz, checked.baud).map_err(|cause| Problem::new("line.baud", cause))?;
    Ok(Some(cycles as f64 / tick as f64))
}

/// Thousandths of a bit time per tick, with its share of frame and reply.
fn frame_bits(checked: &CheckedScenario, config: &Config) -> u128 {
    let ticks = job(config, &Arc::from([])).ticks_per_frame(&checked.host);
    let content = vec![0xff; 4 + usize::from(ticks) * usize::from(config.channels())];
    let bytes = (encode_frame(&content).len() + ACK_LEN) as u128;
    PART_OF_BIT * (10 * bytes + EXCHANGE_BITS) / u128::from(ticks)
}

pub(super) fn pulses(tick: &[u8]) -> u64 {
    let mut sum = 0;
    for byte in tick.get(..Tick::default().len()).unwrap_or(tick) {
        sum += u64::from(ChannelCommand::parse(*byte).steps);
    }
    sum
}
