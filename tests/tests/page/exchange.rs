//! Links with digests, views in links, and imported files.

use anyhow::{Context, Result, ensure};
use serde_json::json;
use stepscope_core::{
    inspect::{
        export::tables::{write_edges_head, write_edges_row},
        packets::packet_table::PacketTable,
        trace::{fingerprint::Fingerprint, run_fingerprint::RunFingerprint},
    },
    peripheral::signal::Record,
    scenario::{link::with_part, presets::PRESETS},
};

use crate::{
    bench::in_browser,
    links::{copied, whole},
    native::{Known, with_distance},
    session::Session,
};

const SEEN: &str = "document.getElementById('seen-message').textContent";
const MESSAGE: &str = "document.getElementById('link-message').textContent";

/// A link of a scenario with the digests of a trace.
fn link(known: &Known, trace: &[Record]) -> String {
    let proof = RunFingerprint::of(vec![Fingerprint::of(trace)]);
    format!("#{}", with_part(known.link.clone(), "d", &proof.emit()))
}

#[test]
fn an_opened_link_is_labeled_as_the_senders_until_it_is_edited() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of(&with_distance(1200.0))?;
        page.open(&format!("#{}", known.link)).await?;
        page.until_digest(&known.digest).await?;
        assert_eq!(page.text("#seen-message").await?, "", "nothing to compare with");
        let link = copied(&page).await?;
        assert_eq!(link, whole(&page, &known));

        let stranger = page.stranger().await?;
        let (_, fragment) = link.split_once('#').context("no fragment")?;
        stranger.open(&format!("#{fragment}")).await?;
        stranger.until(&format!("{SEEN}.startsWith('Reproduced bit-exactly: ')")).await?;
        ensure!(stranger.text("#seen-message").await?.contains(&known.digest), "the digest is named");
        // The digests stay in the address, also after a reload.
        stranger.until_equal("location.hash", &json!(format!("#{fragment}"))).await?;
        stranger.picture("reproduced").await?;

        stranger.fill("source.motion.axes[0].moves[0].cosine.distance", "1300").await?;
        stranger.until_digest(&Known::of(&with_distance(1300.0))?.digest).await?;
        ensure!(!stranger.visible("#seen-message").await?, "it is another run now");
        stranger.until("!location.hash.includes('&d=')").await
    })
}

#[test]
fn a_link_of_a_different_run_locates_the_first_difference() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of(&with_distance(1200.0))?;
        let mut trace = known.recording.trace.clone();
        let changed = trace.len() / 2;
        trace.get_mut(changed).context("a record")?.levels.0 ^= 1 << 35;
        page.open(&link(&known, &trace)).await?;
        page.until(&format!("{SEEN}.startsWith('The run differs from the sender')")).await?;
        let said = page.text("#seen-message").await?;
        ensure!(said.contains("is between edge") && !said.contains("version"), "{said}");
        page.click("#seen-message button").await?;
        let cycle = known.recording.trace.get(changed).context("a record")?.cycle.0;
        let (start, end): (f64, f64) = page
            .eval("['window-start', 'window-end'].map((id) => parseFloat(document.getElementById(id).value))")
            .await?;
        let at = known.seconds(cycle) * 1000.0;
        ensure!(start <= at && at <= end, "{at} ms is not between {start} and {end}");
        let whole = known.seconds(known.recording.trace.last().context("records")?.cycle.0) * 1000.0;
        ensure!(end - start < whole / 4.0, "that is not a place: {start} to {end} of {whole}");
        page.picture("difference").await
    })
}

#[test]
fn unreadable_digests_are_ignored_with_a_message() -> Result<()> {
    in_browser(|page| async move {
        let known = Known::of(&with_distance(1200.0))?;
        let good = link(&known, &known.recording.trace);
        let rows = [
            (format!("#{}&d=0123456789abcdef", known.link), "cut short or changed"),
            (good.get(..good.len() - 3).context("long")?.to_owned(), "cut short or changed"),
            (good.replace("&d=1.", "&d=7."), "newer version of Stepscope"),
            (
                with_part(
                    format!("#{}", known.link),
                    "d",
                    &RunFingerprint::of(vec![Fingerprint::of(&known.recording.trace); 2]).emit(),
                ),
                "of 2 controllers",
            ),
        ];
        for (fragment, says) in rows {
            page.open(&fragment).await?;
            page.until_digest(&known.digest).await?;
            page.until(&format!("{SEEN}.includes('{says}')")).await.with_context(|| fragment.clone())?;
            let text = page.text("#seen-message").await?;
            ensure!(
                text.ends_with("ignored.") || text.ends_with("request a new link."),
                "{fragment}: {text}"
            );
        }
        Ok(())
    })
}

#[test]
fn the_view_of_a_link_is_shown_without_its_invalid_parts() -> Result<()> {
    in_browser(|page| async move {
        let preset =
            PRESETS.iter().find(|preset| preset.id == "four-controllers-framed").context("a preset")?;
        let known = Known::preset(preset)?;
        let digest = Known::digest_of(preset.json, 2)?;
        page.open(&format!("#{}&v=1000-90000.k2.a2000.b80000.tpulses.zebra.x99.ufeet", known.link)).await?;
        page.until_digest(&digest).await?;
        assert_eq!(page.eval::<String>("document.getElementById('controller').value").await?, "2");
        // The address has exactly the parts that were read.
        let wanted = format!("#{}&v=1000-90000.k2.a2000.b80000.tpulses", known.link);
        page.until_equal("location.hash", &json!(wanted)).await?;
        // In the form of the first links.
        page.open(&format!("#{}&v=1000-90000", known.link)).await?;
        page.until_equal("location.hash", &json!(format!("#{}&v=1000-90000", known.link))).await
    })
}

/// Drops a file with this name and text on the page.
pub(crate) async fn drop_file(page: &Session, name: &str, text: &str) -> Result<()> {
    let script = "const data = new DataTransfer(); data.items.add(new File([arguments[1]], arguments[0]));
        const over = new DragEvent('dragover', { dataTransfer: data, bubbles: true, cancelable: true });
        document.body.dispatchEvent(over);
        const hinted = !document.getElementById('drop-hint').hidden;
        document.body.dispatchEvent(new DragEvent('drop', { dataTransfer: data, bubbles: true, cancelable: true }));
        return hinted && over.defaultPrevented && document.getElementById('drop-hint').hidden;";
    ensure!(
        page.js::<bool>(script, vec![json!(name), json!(text)]).await?,
        "no hint while {name} is dragged"
    );
    Ok(())
}

#[test]
fn a_dropped_scenario_is_shown_and_undo_restores_the_work() -> Result<()> {
    in_browser(|page| async move {
        let own = Known::of(&with_distance(800.0))?;
        page.open("").await?;
        page.fill("source.motion.axes[0].moves[0].cosine.distance", "800").await?;
        page.until_digest(&own.digest).await?;
        let preset = PRESETS.iter().find(|preset| preset.id == "song-2021-plateau").context("a preset")?;
        let known = Known::preset(preset)?;
        drop_file(&page, "plateau.json", preset.json).await?;
        page.until_digest(&known.digest).await?;
        let said = page.text("#link-message").await?;
        ensure!(said.contains("plateau.json") && said.contains("Undo"), "{said}");
        page.click("#undo").await?;
        page.until_digest(&own.digest).await?;

        // A file that cannot be opened changes nothing.
        for (name, text, says) in [
            ("bad.json", r#"{"bus":{"slots":200},"clok_hz":1}"#, "2 problems: clok_hz"),
            ("cut.json", "{\"bus\":", "invalid JSON"),
            ("huge.csv", "start_cycle,bytes\n1,00\n1,zz\n", "line 3: bytes are “zz”"),
            ("both.csv", "start_cycle,bytes\n5,00\n6,00\n", "both.csv has a problem: "),
            ("picture.png", "\u{fffd}PNG", "unknown format"),
            ("run.vcd", "$timescale 1 ps $end\n", "the file ends before $enddefinitions"),
            ("link.txt", "see https://example.org/#c=1.j.e30.00000000", "cut short or changed"),
        ] {
            drop_file(&page, name, text).await?;
            page.until(&format!("{MESSAGE}.includes({})", json!(says)))
                .await
                .with_context(|| name.to_owned())?;
            ensure!(
                page.eval::<bool>("document.getElementById('link-message').classList.contains('error')")
                    .await?
            );
            page.until_digest(&own.digest).await?;
        }
        // A link as text.
        let text = format!("Look at this: {}#{} !", page.address(), known.link);
        drop_file(&page, "link.txt", &text).await?;
        page.until_digest(&known.digest).await
    })
}

#[test]
fn saved_packets_and_edges_are_imported() -> Result<()> {
    in_browser(|page| async move {
        let preset = PRESETS.iter().find(|preset| preset.id == "song-2021-plateau").context("a preset")?;
        let known = Known::preset(preset)?;
        page.open(&format!("#{}", known.link)).await?;
        page.until_digest(&known.digest).await?;
        let (config, recording) = (known.experiment.config(), &known.recording);
        let table = |records: &[Record]| -> Result<String> {
            let mut text = String::new();
            write_edges_head(&mut text, config.channels())?;
            for record in records {
                write_edges_row(&mut text, *record, config.clock_hz(), config.channels())?;
            }
            Ok(text)
        };
        drop_file(&page, "run.csv", &table(&recording.trace)?).await?;
        page.until(&format!(
            "{MESSAGE}.startsWith('run.csv is bit-identical') && {MESSAGE}.includes('the whole run')"
        ))
        .await?;

        let mut other = recording.trace.clone();
        let at = other.len() / 3;
        other.get_mut(at).context("a record")?.levels.0 ^= 1;
        drop_file(&page, "other.csv", &table(&other)?).await?;
        page.until(&format!("{MESSAGE}.startsWith('other.csv differs from this run')")).await?;
        let said = page.text("#link-message").await?;
        ensure!(said.contains("STEP0 is") && said.contains("in line"), "{said}");
        page.click("#link-message button").await?;
        let cycle = recording.trace.get(at).context("a record")?.cycle.0;
        page.until(&format!("location.hash.includes('a{cycle}')")).await?;

        drop_file(&page, "bad.csv", &table(&recording.trace)?.replacen("\n0,0,0,", "\n0,0,2,", 1)).await?;
        page.until(&format!("{MESSAGE}.includes('line 2')")).await?;

        let mut packets = String::new();
        let run = known.experiment.run(&mut Vec::new());
        let table = PacketTable::new(&known.experiment, &run, 0, &recording.packets);
        PacketTable::write_head(&mut packets)?;
        (0..table.len()).try_for_each(|index| table.write_row(&mut packets, index))?;
        drop_file(&page, "packets.csv", &packets).await?;
        page.until(&format!("{MESSAGE}.includes('packets of packets.csv are sent again')")).await?;
        page.until_digest(&known.digest).await?;
        ensure!(
            page.eval::<bool>(
                "document.querySelector('[data-path=\"source.line.sends[0].start_cycle\"]') !== null"
            )
            .await?,
            "it is a line script"
        );
        page.click("#undo").await?;
        page.until_equal("location.hash.split('&')[0]", &json!(format!("#{}", known.link))).await
    })
}
