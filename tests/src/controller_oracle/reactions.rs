//! Step 4 of G1: reactions in their order, each based on the results of the previous ones; and the effects of a move's end.

use super::buttons::ORDER;
use super::engine::Order;
use super::parameters::Policy;
use super::room::{Alarm, Kept, Room, State};

impl Room {
    /// G1's list.
    pub(super) fn reactions(&mut self) {
        if !self.power() {
            return;
        }
        self.estop();
        self.switch_in_homing();
        self.limits();
        self.until();
        self.waiting_move();
        self.ends_of_moves();
        self.timer();
        self.ends_of_moves();
        for button in ORDER {
            self.button(button);
            self.ends_of_moves();
        }
        self.condition_of_wait();
        self.end_of_self_test();
    }

    /// The end of a move, and of a move that begins in its place and also ends in c.
    pub(super) fn ends_of_moves(&mut self) {
        while self.s.motion.as_ref().is_some_and(|motion| motion.over) {
            self.jump_costs_trust();
            let Some(motion) = self.s.motion.take() else { return };
            match motion.order {
                Order::Jog => {
                    self.s.state = if self.s.jog_from_debug { State::Debug } else { State::Ready };
                }
                Order::Homing if motion.at_limit => self.alarm(Alarm::Homing),
                Order::Homing => self.leg_ends(),
                Order::Group | Order::Return if motion.at_limit => self.alarm(Alarm::Limit),
                Order::Group | Order::Return if motion.rem > 0 && !motion.until_met => {
                    if self.s.state == State::Pausing {
                        self.s.state = State::Paused;
                        self.s.kept = Some(Kept {
                            rem: motion.rem,
                            right: motion.right,
                            state: State::Running,
                            left: None,
                        });
                    } else {
                        // `start` came after the stop: the remaining steps begin at its end, as from PAUSED.
                        self.begin_rest(motion.rem, motion.right);
                    }
                }
                // Reading: a return that ends in PAUSING without remaining steps has ended: READY.
                Order::Return => self.s.state = State::Ready,
                Order::Group => self.move_of_group_ends(motion.until_met),
            }
        }
    }

    /// A move of `rem` steps by G3 with the requested speed and level.
    pub(super) fn begin_rest(&mut self, rem: i128, right: bool) {
        if self.s.program.is_some() {
            self.s.state = State::Running;
            self.begin_rest_of_group(rem, right);
        } else {
            self.s.state = State::Returning;
            let [rate_hz, level] = self.s.numbers.return_to_zero();
            let motion = self.ramped(Order::Return, rem, right, rate_hz, level);
            self.begin(motion);
        }
    }

    fn timer(&mut self) {
        if self.s.timer != Some(self.now) {
            return;
        }
        match self.s.state {
            State::Running | State::Delay => {
                self.s.timer = None;
                self.begin_group();
            }
            State::Wait => self.time_of_wait_ends(),
            _ => {}
        }
    }

    /// In s + `self_test_cycles` memory is read; then, at once or with the complete opening record, the test ends.
    fn end_of_self_test(&mut self) {
        if self.s.state != State::SelfTest {
            return;
        }
        if self.now == self.end_of_test() {
            self.read_memory();
        }
        let at_once = self.plan.controller.memory.policy == Policy::WriteAhead;
        if !self.s.memory_read || !(at_once || self.s.self_test.opened) {
            return;
        }
        if self.s.self_test.estop {
            self.alarm(Alarm::Estop);
        } else if self.s.self_test.none_valid {
            self.alarm(Alarm::Memory);
        } else {
            self.s.state = State::Ready;
        }
    }
}
