//! The shipped page: it is stored on the user's device, and replaced on request.

use std::{fs, path::Path};

use anyhow::{Context, Result, ensure};

use crate::{
    bench::{dist, in_browser_at, in_browser_that_keeps},
    native::{DISTANCE, Known, with_distance},
    programs::{Folder, Program},
    session::Session,
};

const BUILD: &str = "const build = { id: \"";

/// Waits until all files of the build are on the device.
async fn until_kept(page: &Session) -> Result<()> {
    page.until("navigator.serviceWorker.controller?.state === 'activated'").await
}

/// A copy of the page that a test may change.
fn copy() -> Result<Folder> {
    let folder = Folder::temporary()?;
    copy_into(&dist()?, &folder.0)?;
    Ok(folder)
}

fn copy_into(from: &Path, to: &Path) -> Result<()> {
    fs::create_dir_all(to)?;
    for entry in fs::read_dir(from)? {
        let entry = entry?;
        let target = to.join(entry.file_name());
        if entry.file_type()?.is_dir() {
            copy_into(&entry.path(), &target)?;
        } else {
            fs::copy(entry.path(), target)?;
        }
    }
    Ok(())
}

/// Replaces a text of a file that occurs once.
fn change(file: &Path, from: &str, to: &str) -> Result<()> {
    let text = fs::read_to_string(file)?;
    ensure!(text.matches(from).count() == 1, "{} must hold once: {from}", file.display());
    Ok(fs::write(file, text.replace(from, to))?)
}

#[test]
fn the_second_visit_needs_no_network() -> Result<()> {
    let server = Program::server(&dist()?)?;
    in_browser_at(&server.address.clone(), |page| async move {
        let known = Known::of(&with_distance(1200.0))?;
        page.open("").await?;
        until_kept(&page).await?;
        drop(server);
        ensure!(
            page.eval::<bool>("fetch('not-kept').then(() => false, () => true)").await?,
            "the server still answers"
        );

        page.open(&format!("#{}", known.link)).await?;
        page.until_digest(&known.digest).await?;
        page.canvas("chart-position").await?.has_curve("--ideal")?;
        page.fill(DISTANCE, "2400").await?;
        page.until_digest(&Known::of(&with_distance(2400.0))?.digest).await?;
        for other in ["licenses.html", "index.html"] {
            page.go(other).await?;
            page.until("document.querySelector('h1') !== null").await?;
        }
        page.ready().await?;
        // This test caused the failed request.
        let complaints = page.complaints().await?;
        ensure!(complaints.iter().all(|line| line.contains("not-kept")), "{complaints:?}");
        Ok(())
    })
}

#[test]
fn a_newer_version_is_offered_and_keeps_the_work() -> Result<()> {
    let folder = copy()?;
    let (web, server) = (folder.0.clone(), Program::server(&folder.0)?);
    in_browser_at(&server.address, |page| async move {
        page.open("").await?;
        until_kept(&page).await?;
        page.fill(DISTANCE, "1234").await?;
        page.until_digest(&Known::of(&with_distance(1234.0))?.digest).await?;
        ensure!(!page.visible("#newer-version").await?, "nothing is newer yet");

        change(&web.join("sw.js"), BUILD, &format!("{BUILD}newer-"))?;
        change(&web.join("index.html"), "<h1>Stepscope</h1>", "<h1>Newer</h1>")?;
        page.open("").await?;
        page.until("!document.getElementById('newer-version').hidden").await?;
        assert_eq!(page.text("h1").await?, "Stepscope", "the version that was there answers");
        page.js::<()>("window.stays = true;", vec![]).await?;
        page.ready().await?;
        ensure!(page.eval::<bool>("window.stays === true").await?, "it reloaded without a request");

        page.click("#reload").await?;
        page.until("document.querySelector('h1')?.textContent === 'Newer'").await?;
        page.ready().await?;
        assert_eq!(page.field(DISTANCE).await?.value, "1234");
        ensure!(!page.visible("#newer-version").await?, "the newest has none that is newer");
        page.until_equal("caches.keys().then((names) => names.length)", &1.into()).await
    })
}

#[test]
fn unbuilt_sources_are_not_cached_and_clear_the_cache_of_a_build() -> Result<()> {
    let folder = copy()?;
    let (web, server) = (folder.0.clone(), Program::server(&folder.0)?);
    in_browser_at(&server.address, |page| async move {
        page.open("").await?;
        until_kept(&page).await?;

        let sources = Path::new(env!("CARGO_MANIFEST_DIR")).join("../web");
        fs::copy(sources.join("sw.js"), web.join("sw.js"))?;
        let index = fs::read_to_string(web.join("index.html"))?;
        let (before, rest) = index.split_once("data-build=\"").context("no data-build")?;
        let (_, after) = rest.split_once('"').context("data-build has no end")?;
        fs::write(web.join("index.html"), format!("{before}data-build=\"development\"{after}"))?;

        page.open("").await?;
        page.until_equal("caches.keys().then((names) => names.length)", &0.into()).await?;
        page.open("").await?;
        assert_eq!(page.eval::<String>("document.documentElement.dataset.build").await?, "development");
        page.until_equal("navigator.serviceWorker.getRegistrations().then((all) => all.length)", &0.into())
            .await
    })
}

#[test]
fn the_page_shows_its_build_and_third_party_licenses() -> Result<()> {
    in_browser_that_keeps(|page| async move {
        page.open("").await?;
        let version = page.eval::<String>("document.getElementById('version').textContent").await?;
        let (number, build) = version.split_once(' ').context(version.clone())?;
        ensure!(number == env!("CARGO_PKG_VERSION") && build.len() > 8, "{version}");
        page.go("licenses.html").await?;
        let text = page.text("body").await?;
        for part in ["rustfft", "plotters", "wasm-bindgen", "Permission is hereby granted"] {
            ensure!(text.contains(part), "{part} is not in the licences");
        }
        Ok(())
    })
}

#[test]
fn the_page_can_be_installed() -> Result<()> {
    in_browser_that_keeps(|page| async move {
        page.open("").await?;
        until_kept(&page).await?;
        let answer = page.devtools("Page.getInstallabilityErrors", serde_json::json!({})).await?;
        let errors = answer["installabilityErrors"].as_array().context("no answer")?.clone();
        // In some versions headless profiles are private, which is not a fault of the page.
        let own: Vec<_> = errors.iter().filter(|error| error["errorId"] != "in-incognito").collect();
        ensure!(own.is_empty(), "{own:?}");
        let manifest = page.devtools("Page.getAppManifest", serde_json::json!({})).await?;
        ensure!(manifest["errors"].as_array().is_some_and(Vec::is_empty), "{manifest}");
        Ok(())
    })
}
