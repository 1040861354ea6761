//! The view Panel and the form of stand-alone controllers, compared with the core for the same presses.
#![allow(clippy::expect_used, reason = "a missing file or program fails the test")]

use anyhow::{Result, ensure};
use fantoccini::actions::{InputSource as _, KeyAction, KeyActions};
use serde_json::json;
use stepscope_core::{
    controller::{StandAlone, State, panel, trust_name},
    peripheral::units::Instant,
    scenario::presets::{CONTROLLER_PLANT_PRESETS, CONTROLLER_PRESETS},
};

use crate::{
    axe,
    bench::in_browser,
    native::Known,
    session::{ENTER, Session},
};

/// What the display shows.
const LCD: &str = "document.querySelector('.lcd')?.textContent";
/// The text of the panel.
const WORDS: &str = "document.querySelector('.panel-words')?.textContent";
/// The outcome of the last press.
const SAID: &str = "document.getElementById('panel-status').textContent";
/// A release follows its press after this time: debouncing, and 10 ms.
const SHORTEST: u64 = 320_000;

/// A controller with these inputs, run for a second.
fn with_inputs(inputs: &str) -> Result<Known> {
    Known::of(&format!(
        r#"{{"run_cycles":16000000,"source":{{"standalone":[{{"pulses_per_unit":565,"axis":{{"max_switch_at_steps":1000}},"inputs":[{inputs}]}}]}}}}"#
    ))
}

/// A controller whose program moves for 100 s, so that a pause is within it even on a slow machine.
fn with_long_program(inputs: &str) -> Result<Known> {
    Known::of(&format!(
        r#"{{"run_cycles":1600000000,"source":{{"standalone":[{{"groups":[{{"move":{{"length":999999,"speed_hz":1000}}}}],"inputs":[{inputs}]}}]}}}}"#
    ))
}

fn press(input: &str, from: u64, until: u64) -> String {
    format!(
        r#"{{"cycle":{from},"input":"{input}","level":1}},{{"cycle":{until},"input":"{input}","level":0}}"#
    )
}

/// Waits for this run, and for the scenario's address.
async fn until_run(page: &Session, known: &Known) -> Result<()> {
    page.until_digest(&known.digest).await?;
    page.until(&format!("location.hash.startsWith('#{}')", known.link)).await
}

/// Opens the page with cursor A at a cycle.
async fn open(page: &Session, known: &Known, cycle: u64) -> Result<()> {
    page.open(&format!("#{}&v=a{cycle}", known.link)).await?;
    page.until(&format!("{LCD} !== undefined && {LCD} !== ''")).await
}

/// The controller at the start of a cycle.
fn at(known: &Known, cycle: u64) -> StandAlone {
    let mut machine = StandAlone::new(known.experiment.stand_alone().expect("a controller"));
    machine.run(Instant(cycle), &mut Vec::new());
    machine
}

/// Waits until display and text are those of a controller.
async fn until_shown(page: &Session, machine: &StandAlone) -> Result<()> {
    let decimals = machine.numbers(0)[1] as u8;
    let word = machine.word(0).expect("a panel");
    let is_off = word.state() == State::Off;
    let lcd = if is_off { String::new() } else { panel::lcd(machine.display(0).expect("a panel"), decimals) };
    page.until_equal(LCD, &json!(lcd)).await?;
    let alarm = word.alarm().name();
    let state = format!("{}{}{alarm}", word.state().name(), if alarm.is_empty() { "" } else { " " });
    let position = match trust_name(word.trust()) {
        "LOST" => "lost",
        "HELD" => "restored",
        _ => "confirmed",
    };
    let words = format!("'{state} · position {position}'");
    page.until(&format!("{WORDS}.startsWith({words})")).await
}

#[test]
fn every_panel_matches_the_core_in_any_cycle() -> Result<()> {
    in_browser(|page| async move {
        let mut shown = 0;
        for preset in CONTROLLER_PRESETS.iter().chain(CONTROLLER_PLANT_PRESETS) {
            let known = Known::preset(preset)?;
            let Some(checked) = known.experiment.stand_alone() else { continue };
            let mut whole = StandAlone::new(checked);
            whole.run(Instant(known.experiment.cost().end_cycle), &mut Vec::new());
            page.open(&format!("#{}", known.link)).await?;
            page.until_digest(&known.digest).await?;
            until_shown(&page, &whole).await?;
            let end = whole.now().0;
            for cycle in [0, 1, end / 3, end / 2 + 1, end - 1] {
                page.follow(&format!("#{}&v=a{cycle}", known.link)).await?;
                page.until_digest(&known.digest).await?;
                let machine = at(&known, cycle);
                until_shown(&page, &machine).await?;
                let place = machine.axis_position(0).expect("a panel");
                let told = "document.querySelector('.axis-words').textContent.replace(/[\\u202f ]/g, '').replaceAll('−', '-')";
                page.until(&format!("{told}.startsWith('Nutat{place}step')")).await?;
            }
            shown += 1;
        }
        ensure!(shown >= 8, "{shown} presets have a panel");
        Ok(())
    })
}

#[test]
fn a_press_at_the_cursor_is_linked_and_can_be_undone() -> Result<()> {
    in_browser(|page| async move {
        let none = with_inputs("")?;
        open(&page, &none, 4_000_000).await?;
        page.click("[data-input='jog_plus']").await?;
        let pressed = with_inputs(&press("jog_plus", 4_000_000, 4_000_000 + SHORTEST))?;
        ensure!(pressed.digest != none.digest, "a jog makes steps");
        until_run(&page, &pressed).await?;
        page.until(&format!("{SAID}.includes('Jog right is pressed at 250')")).await?;
        page.click("#undo").await?;
        until_run(&page, &none).await?;
        page.until(&format!("{SAID} === ''")).await?;
        // The duration of the press: 0.2 s at 1000 Hz.
        page.js::<bool>("const hold = document.querySelector('#view-panel .head input'); hold.value = '0.2'; hold.dispatchEvent(new Event('change')); return true;", vec![]).await?;
        // The cursor moved behind the first press; a button releases it.
        let from = 4_000_000 + 2 * SHORTEST;
        page.until(&format!("location.hash.includes('a{from}')")).await?;
        page.click("[data-input='jog_plus']").await?;
        until_run(&page, &with_inputs(&press("jog_plus", from, from + 3_200_000))?).await?;
        page.js::<bool>("[...document.querySelectorAll('#view-panel .head button')].find((each) => each.textContent === 'To the end').click(); return true;", vec![]).await?;
        page.until("document.querySelector('.panel-at').textContent.startsWith('at the end')").await
    })
}

#[test]
fn the_panel_shows_the_next_action_and_unreached_speeds() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of(
            r#"{"source":{"standalone":[{"groups":[{"move":{"length":100,"speed_hz":4000}}],"memory":{"initial":"blank"}}]}}"#,
        )?;
        open(&page, &known, 3_200_000).await?;
        let advice = "document.querySelector('.panel-advice').textContent";
        page.until(&format!("{WORDS}.startsWith('ALARM MEMORY · position lost')")).await?;
        page.until(&format!("{advice}.startsWith('The memory is invalid')")).await?;
        let speed = "source.standalone[0].groups[0].move.speed_hz";
        page.until(&format!("document.querySelector(`[data-path='{speed}']`).closest('.field').querySelector('.also').textContent.includes('because 4000 Hz needs')")).await?;
        page.click("[data-input='clear']").await?;
        page.until(&format!("{advice}.startsWith('The position is lost')")).await?;
        // Homing is not set up: the button and the log state it.
        page.until("document.querySelector(`[data-input='home']`).title.includes('not set up')").await?;
        page.click("[data-input='home']").await?;
        page.until("document.querySelector('.ignored').textContent.includes('homing is not set up')").await
    })
}

#[test]
fn the_power_is_cut_at_the_cursor_and_comes_back() -> Result<()> {
    in_browser(|page| async move {
        let jog = press("jog_plus", 4_000_000, 8_000_000);
        open(&page, &with_inputs(&jog)?, 6_000_000).await?;
        page.click("[data-input='power'][data-level='0']").await?;
        let cut = r#"{"cycle":6000000,"input":"power","level":0}"#;
        let known = with_inputs(&jog.replacen("},{", &format!("}},{cut},{{"), 1))?;
        until_run(&page, &known).await?;
        page.until("document.querySelector(`[data-input='power'][data-level='0']`).disabled").await?;
        page.devtools("Emulation.setEmulatedMedia", json!({ "features": [] })).await?;
        // Its own last status.
        page.press(".strip canvas", "\u{e00c}").await?;
        until_shown(&page, &at(&known, 16_000_000)).await?;
        page.click("[data-input='estop'][data-level='1']").await?;
        page.until(&format!("{SAID}.startsWith('Emergency stop is 1')")).await
    })
}

#[test]
fn an_impossible_input_is_reported_and_changes_nothing() -> Result<()> {
    in_browser(|page| async move {
        let jog = press("jog_plus", 4_000_000, 8_000_000);
        let known = with_inputs(&jog)?;
        open(&page, &known, 4_000_000).await?;
        page.click("[data-input='jog_plus']").await?;
        page.until(&format!("{SAID}.includes('“jog right” already changes at 250 ms')")).await?;
        page.click("[data-input='limit_max']").await?;
        page.until(&format!("{SAID}.includes('The right limit switch is driven by')")).await?;
        page.ready().await?;
        until_run(&page, &known).await?;
        // A press without effect is reported with its location.
        page.click("[data-input='ok']").await?;
        page.until("document.querySelector('.ignored').textContent.includes('1 press ignored')").await?;
        page.until("document.querySelector('.ignored').textContent.includes('ok at 260 ms in JOG')").await
    })
}

#[test]
fn an_input_is_selected_moved_and_removed_by_keys_and_field() -> Result<()> {
    in_browser(|page| async move {
        let jog = press("jog_plus", 4_000_000, 8_000_000);
        open(&page, &with_inputs(&jog)?, 0).await?;
        let chosen = "document.querySelector('.entry-line input').value";
        page.press(".strip canvas", "nn").await?;
        page.until(&format!("{chosen} === '8000000'")).await?;
        page.press(".strip canvas", ">").await?;
        page.until(&format!("{chosen} > 8000000")).await?;
        let there: String = page.eval(chosen).await?;
        until_run(&page, &with_inputs(&press("jog_plus", 4_000_000, there.parse()?))?).await?;
        // A time is accepted, too, unless it is that of another entry of the input.
        let fill = |text: &str| {
            format!(
                "const field = document.querySelector('.entry-line input'); field.value = '{text}'; field.dispatchEvent(new Event('change')); return true;"
            )
        };
        page.js::<bool>(&fill("0.45 s"), vec![]).await?;
        until_run(&page, &with_inputs(&press("jog_plus", 4_000_000, 7_200_000))?).await?;
        page.js::<bool>(&fill("4000000"), vec![]).await?;
        page.until(&format!("{SAID}.includes('“jog right” would change twice at 250 ms')")).await?;
        page.press(".strip canvas", "\u{e017}").await?;
        until_run(&page, &with_inputs(r#"{"cycle":4000000,"input":"jog_plus","level":1}"#)?).await
    })
}

#[test]
fn a_program_is_started_paused_and_cut_with_keys_only() -> Result<()> {
    in_browser(|page| async move {
        open(&page, &with_long_program("")?, 3_200_000).await?;
        page.press("[data-input='start']", &ENTER.to_string()).await?;
        let start = press("start", 3_200_000, 3_200_000 + SHORTEST);
        until_run(&page, &with_long_program(&start)?).await?;
        // A live press by key: it is added to the script while it is held, and is one undo step.
        page.press("#view-panel .head [aria-label='Live'] button", &ENTER.to_string()).await?;
        page.until("document.querySelector('.panel-at').textContent.startsWith('live')").await?;
        page.js::<bool>("document.querySelector(`[data-input='pause']`).focus(); return true;", vec![])
            .await?;
        let hold = KeyActions::new("keys".to_owned())
            .then(KeyAction::Down { value: ' ' })
            .pause(std::time::Duration::from_millis(120))
            .then(KeyAction::Up { value: ' ' });
        page.actions(hold).await?;
        page.press("#view-panel .head [aria-label='Live'] button", &ENTER.to_string()).await?;
        page.until(&format!("{WORDS}.startsWith('PAUS')")).await?;
        page.click("#undo").await?;
        until_run(&page, &with_long_program(&start)?).await
    })
}

#[test]
fn the_program_is_a_table_of_groups_in_units_of_length() -> Result<()> {
    in_browser(|page| async move {
        let preset =
            CONTROLLER_PRESETS.iter().find(|preset| preset.id == "zhang-2012-controller").expect("a preset");
        let known = Known::preset(preset)?;
        page.open(&format!("#{}", known.link)).await?;
        page.until_digest(&known.digest).await?;
        let group = "source.standalone[0].groups";
        let beside = format!(
            "document.querySelector(`[data-path='{group}[0].move.length']`).closest('.field').querySelector('.also').textContent.replace(/\\u202f/g, '')"
        );
        page.until(&format!("{beside} === '= 30.5 units, 17233 steps'")).await?;
        page.click("button[title='Add group to controller 0']").await?;
        page.choose(&format!("[data-path='{group}[1]#kind']"), "wait").await?;
        page.until(&format!("document.querySelector(`[data-path='{group}[1].wait.input']`)")).await?;
        for kind in ["move_to", "set", "repeat", "jump", "home", "profile", "move"] {
            page.choose(&format!("[data-path='{group}[1]#kind']"), kind).await?;
            page.ready().await?;
        }
        page.click("button[title='Remove group 2']").await?;
        page.until_digest(&known.digest).await?;
        // Optional homing, and another controller with its channel.
        page.js::<bool>("for (const part of document.querySelectorAll('#fields details')) part.open = true; document.querySelector(`[data-path='source.standalone[0].home#kind']`).click(); return true;", vec![]).await?;
        page.until("document.querySelector(`[data-path='source.standalone[0].home.coarse_hz']`)").await?;
        page.click("button[title='Add controller']").await?;
        page.until("document.querySelector(`[data-path='bus.channels']`).value === '2'").await?;
        page.until("document.querySelectorAll('#view-panel .head select')[0].options.length === 2").await
    })
}

#[test]
fn axe_finds_nothing_in_the_panel() -> Result<()> {
    in_browser(|page| async move {
        let mut wrong = Vec::new();
        for (width, height) in [(1366, 768), (390, 844)] {
            page.screen(width, height).await?;
            page.open("").await?;
            page.preset("controller-limit").await?;
            page.ready().await?;
            if width < 900 {
                page.click("#tab-panel").await?;
            }
            page.until(&format!("{LCD} !== undefined && {LCD} !== ''")).await?;
            page.press(".strip canvas", "n").await?;
            page.js::<bool>("document.querySelector(`[data-input='zero']`).scrollIntoView({ block: 'center' }); return true;", vec![]).await?;
            page.click("[data-input='zero']").await?;
            page.click("[data-input='system']").await?;
            page.ready().await?;
            for theme in ["light", "dark"] {
                let media = json!({ "features": [{ "name": "prefers-color-scheme", "value": theme }] });
                page.devtools("Emulation.setEmulatedMedia", media).await?;
                axe::look(&page, &format!("{theme} at {width}"), &mut wrong).await?;
                page.picture(&format!("panel-{width}-{theme}")).await?;
            }
        }
        axe::none(&wrong)
    })
}

/// A separate worker of the page, with requests in an order that a slow network causes.
const INTERLEAVED: &str = r"
    const [alone, motion] = given;
    const { worker: address } = document.getElementById('main').dataset;
    const core = await WebAssembly.compile(await (await fetch(document.getElementById('core').href)).arrayBuffer());
    const worker = new Worker(address, { type: 'module' });
    const heard = [];
    worker.onmessage = ({ data }) => {
      if (data.event !== 'progress') heard.push(data);
    };
    const until = async (found) => {
      for (let i = 0; i < 6000 && !heard.some(found); i += 1) await new Promise((rested) => setTimeout(rested, 50));
      return heard.find(found);
    };
    worker.postMessage({ run: 1, json: motion, quiet: true });
    worker.postMessage({ id: 1, method: 'check', args: ['{}'] });
    worker.postMessage({ module: core });
    const restored = await until(({ event }) => event === 'restored');
    worker.postMessage({ run: 2, json: alone });
    worker.postMessage({ id: 2, method: 'encode_link', args: [alone] });
    worker.postMessage({ id: 3, method: 'check', args: [motion] });
    worker.postMessage({ run: 3, json: motion });
    await until(({ event, run }) => event === 'done' && run === 3);
    const link = await until(({ id }) => id === 2);
    await new Promise((rested) => setTimeout(rested, 600));
    worker.postMessage({ id: 4, method: 'summary', args: [] });
    const summary = await until(({ id }) => id === 4);
    worker.terminate();
    const wrong = heard.filter(({ event, error }) => error || event === 'failed');
    return [Boolean(restored), String(link?.value).startsWith('c='), summary?.value.controllers[0].digest, JSON.stringify(wrong)];
";

#[test]
fn requests_between_two_runs_are_in_order_and_punctual() -> Result<()> {
    in_browser(|page| async move {
        let [alone, motion] = [with_inputs(&press("jog_plus", 4_000_000, 8_000_000))?, Known::of("{}")?];
        page.open("").await?;
        let script = format!("return (async (given) => {{ {INTERLEAVED} }})([...arguments]);");
        let given = vec![json!(alone.scenario.to_json()), json!(motion.scenario.to_json())];
        let found: (bool, bool, String, String) = page.js(&script, given).await?;
        assert_eq!(found, (true, true, motion.digest.clone(), "[]".to_owned()));
        Ok(())
    })
}
