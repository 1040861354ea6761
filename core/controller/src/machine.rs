//! All stand-alone controllers of a scenario on one bus (Part G), cycle by cycle or event by event.

use crate::{
    checked::CheckedSetup,
    controller::{Controller, NEVER},
    input::Signal,
    limits,
    panel::PanelRecord,
    parameters::Parameters,
    script::{self, Script},
    work::Work,
};
use alloc::{rc::Rc, vec::Vec};
use stepscope_peripheral::{
    signal::{Event, Levels, Record, Sink},
    units::{Cycles, Instant},
};

/// The controllers: controller i drives channel i, and the bus shows the AND of their EN.
///
/// ```
/// use stepscope_controller::{StandAlone, State, input::{Change, Input, Signal}, parameters::{Group, Move,
///     Parameters, Setup}};
/// use stepscope_peripheral::{signal::Record, units::Instant};
///
/// // One unit of 100 steps to the right, as soon as memory is read and start is held for 10 ms.
/// let groups = vec![Group::Move(Move { length: 10, ..Move::default() })];
/// let start = Input { cycle: Instant(2_500_000), change: Change::Level(Signal::Start, true) };
/// let setup = Setup { controllers: vec![Parameters { groups, inputs: vec![start], ..Parameters::default() }], ..Setup::default() };
/// let mut machine = StandAlone::new(&setup.check().expect("it holds"));
/// let mut trace: Vec<Record> = Vec::new();
/// machine.run(Instant::NEVER, &mut trace);
/// assert_eq!((machine.state(0), machine.position(0)), (Some(State::Ready), Some(100)));
/// assert_eq!(trace.len(), 1 + 1 + 2 * 100, "reset, DIR, and two edges a step");
/// ```
#[derive(Clone, Debug)]
pub struct StandAlone {
    pub(crate) checked: CheckedSetup,
    pub(crate) controllers: Vec<Controller>,
    pub(crate) due: Vec<u64>,
    pub(crate) now: u64,
    acted: u64,
    levels: Levels,
    pub(crate) begun: u64,
    work: Option<Work>,
}

impl StandAlone {
    /// The controllers before cycle 0.
    #[must_use]
    pub fn new(checked: &CheckedSetup) -> Self {
        let first = checked.controllers().first();
        let shared = first.into_iter().flat_map(|first| first.inputs.iter().copied());
        let shared = script::sorted(shared.filter(|input| script::is_shared(input.change)));
        let make = |(index, parameters): (usize, &Rc<Parameters>)| {
            let own = script::sorted(parameters.inputs.iter().copied());
            // The first one has what all share among its own.
            let script = Script::new(own, if index == 0 { Rc::new([]) } else { shared.clone() });
            Controller::new(checked, parameters, script)
        };
        let controllers: Vec<Controller> = checked.controllers().iter().enumerate().map(make).collect();
        Self {
            checked: checked.clone(),
            due: controllers.iter().map(|_| 0).collect(),
            controllers,
            now: 0,
            acted: 0,
            levels: Levels::RESET,
            begun: 0,
            work: None,
        }
    }

    /// The cycle that the next call of [`Self::clock`] is; as many have passed.
    #[must_use]
    pub const fn now(&self) -> Instant {
        Instant(self.now)
    }

    /// Advances one cycle and gives the levels of all signals in it.
    pub fn clock(&mut self, sink: &mut impl Sink) -> Levels {
        self.due.fill(0);
        self.cycle(sink);
        self.levels
    }

    /// Runs the next cycle, in the controllers for which something is due.
    fn cycle(&mut self, sink: &mut impl Sink) {
        let now = self.now;
        (self.now, self.acted) = (now.saturating_add(1), now);
        if self.work.is_none() {
            for (index, (controller, due)) in self.controllers.iter_mut().zip(&mut self.due).enumerate() {
                if *due > now {
                    continue;
                }
                // What the axis holds closed at reset is told in cycle 0.
                let heard = if now == 0 { 1 << Signal::Power as u32 } else { controller.inputs.all_raw() };
                let (begun, shown) = (controller.begun.count, controller.panel.len());
                controller.cycle(now);
                *due = controller.due().max(self.now);
                self.begun += controller.begun.count - begun;
                tell(index as u8, controller, (now, heard, shown), sink);
            }
        }
        let levels = self.shown();
        if now == 0 || levels != self.levels {
            self.levels = levels;
            sink.record(Record { cycle: Instant(now), levels });
        }
        if self.begun > limits::MAX_GROUPS_BEGUN && self.work.is_none() {
            self.stop();
        }
    }

    fn stop(&mut self) {
        let most = self.controllers.iter().enumerate().max_by_key(|(_, controller)| controller.begun.count);
        let Some((controller, begun)) = most.map(|(index, controller)| (index, controller.begun)) else {
            return;
        };
        let (first_group, last_group) = begun.range();
        self.work = Some(Work { controller, first_group, last_group, is_endless: begun.is_endless() });
    }

    fn shown(&self) -> Levels {
        let mut bits = Levels::RESET.0;
        for (channel, controller) in self.controllers.iter().enumerate() {
            let pins = &controller.pins;
            bits |= u64::from(pins.step) << channel;
            bits |= u64::from(pins.dir) << (Levels::DIR_SHIFT as usize + channel);
            if !pins.en {
                bits &= !Levels::EN;
            }
        }
        Levels(bits)
    }

    /// Next cycle in which something can change; `u64::MAX` at the end.
    fn deadline(&self) -> u64 {
        if self.now == 0 {
            return 0;
        }
        if self.work.is_some() {
            return NEVER;
        }
        self.due.iter().copied().min().map_or(NEVER, |due| if due == NEVER { due } else { due.max(self.now) })
    }

    /// For how many cycles nothing can change; `None` if it is for ever.
    #[must_use]
    pub fn cycles_until_event(&self) -> Option<Cycles> {
        match self.deadline() {
            NEVER => None,
            deadline => Some(Cycles(deadline - self.now)),
        }
    }

    /// Passes cycles in which nothing changes: no more than [`Self::cycles_until_event`] says. What goes beyond
    /// is not skipped.
    pub fn advance(&mut self, cycles: Cycles) {
        self.now = self.now.saturating_add(cycles.0).min(self.deadline());
    }

    /// Runs until cycle `until` is the next, as fast as the events allow; with [`Instant::NEVER`], until nothing can
    /// change any more: then the last cycle run is the last in which something could. Stops early where the sink asks for
    /// a pause, and where too many groups have begun ([`Self::work`]).
    pub fn run(&mut self, until: Instant, sink: &mut impl Sink) {
        self.run_events(until, u64::MAX, sink);
    }

    /// The same for no more than so many cycles in which something can change; false where there were more.
    pub fn run_events(&mut self, until: Instant, events: u64, sink: &mut impl Sink) -> bool {
        for _ in 0..events {
            if sink.paused() {
                return true;
            }
            let deadline = self.deadline();
            if deadline >= until.0 {
                if until != Instant::NEVER {
                    self.now = self.now.max(until.0);
                    self.settle();
                }
                return true;
            }
            self.now = deadline;
            self.cycle(sink);
        }
        false
    }

    /// Memories that write the same again and again have come so far.
    fn settle(&mut self) {
        for (controller, due) in self.controllers.iter_mut().zip(&mut self.due) {
            controller.eeprom.settle(self.now);
            *due = (*due).min(controller.eeprom.due());
        }
    }

    /// The first cycle after the last in which something could change, once nothing can any more.
    #[must_use]
    pub const fn rests_from(&self) -> Instant {
        Instant(self.acted.saturating_add(1))
    }

    /// Whether nothing can change any more: no input left, no move, timer or write under way. A memory that writes the
    /// same record again and again, because no sequence number is greater than its newest, keeps no run from its end.
    #[must_use]
    pub fn at_rest(&self) -> bool {
        self.now > 0
            && (self.work.is_some() || self.controllers.iter().all(|controller| controller.due() == NEVER))
    }

    /// Too many groups have begun: the run has ended there.
    #[must_use]
    pub const fn work(&self) -> Option<Work> {
        self.work
    }
}

/// Tells what changed in cycle `now` next to the bus: raw levels that were `heard`, and a panel with so many records before.
fn tell(index: u8, controller: &Controller, (now, heard, shown): (u64, u32, usize), sink: &mut impl Sink) {
    let raw = controller.inputs.all_raw();
    let changed = |signal: &Signal| (raw ^ heard) >> *signal as u32 & 1 != 0;
    if raw != heard {
        for signal in Signal::ALL.into_iter().filter(changed) {
            let level = controller.inputs.raw(signal);
            let event = Event::Input { controller: index, input: signal as u8, level };
            sink.event(Instant(now), event);
        }
    }
    if let Some(&PanelRecord { cycle, word, position, display }) = controller.panel.get(shown) {
        sink.event(cycle, Event::Panel { controller: index, word: word.0, position, display });
    }
}
