//! Tests share browsers, but no data.

use std::collections::BTreeMap;

use anyhow::{Result, ensure};
use fantoccini::actions::{InputSource as _, KeyAction, KeyActions};
use serde_json::{Value, json};

use crate::{
    bench::in_browser_that_keeps,
    session::{SHIFT, Session},
};

/// Stores something in every place available to a page.
const LEAVE: &str = "
    localStorage.setItem('left', 'behind');
    sessionStorage.setItem('left', 'behind');
    document.cookie = 'left=behind; max-age=3600';
    history.pushState(null, '', '?left');
    open('help.html');
    return Promise.all([
        new Promise((done, fail) => {
            const opening = indexedDB.open('left', 1);
            opening.onsuccess = done;
            opening.onerror = fail;
        }),
        caches.open('left').then((cache) => cache.put('left', new Response('behind'))),
        navigator.clipboard.writeText('left behind'),
        navigator.serviceWorker.ready,
    ]).then(() => true);";

/// Everything that a user finds of it, by name.
const FOUND: &str = "
    return (async () => ({
        'local storage': localStorage.getItem('left'),
        'session storage': sessionStorage.getItem('left'),
        cookie: document.cookie,
        databases: (await indexedDB.databases()).map(({ name }) => name),
        caches: await caches.keys(),
        workers: (await navigator.serviceWorker.getRegistrations()).length,
        controlled: navigator.serviceWorker.controller !== null,
        clipboard: (await navigator.permissions.query({ name: 'clipboard-read' })).state,
        script: window.left ?? null,
        history: history.length,
        'inner size': [innerWidth, innerHeight],
        ratio: devicePixelRatio,
        dark: matchMedia('(prefers-color-scheme: dark)').matches,
        'forced colors': matchMedia('(forced-colors: active)').matches,
        still: matchMedia('(prefers-reduced-motion: reduce)').matches,
        print: matchMedia('print').matches,
        online: navigator.onLine,
        language: navigator.language,
        zone: Intl.DateTimeFormat().resolvedOptions().timeZone,
        agent: navigator.userAgent,
        cores: navigator.hardwareConcurrency,
        touch: navigator.maxTouchPoints,
        hidden: document.hidden,
        focus: document.hasFocus(),
    }))();";

type Found = BTreeMap<String, Value>;

/// What a user finds before the page's own scripts have run.
async fn found(page: &Session) -> Result<Found> {
    // A page without scripts, so that everything found was there before.
    page.go("licenses.html").await?;
    page.js(FOUND, vec![]).await
}

/// Presses a key; returns the modifier keys that were held.
async fn held(page: &Session) -> Result<Vec<String>> {
    page.js::<()>(
        "addEventListener('keydown', (event) => { window.held = ['shiftKey', 'altKey', 'ctrlKey'].filter((key) => event[key]); }); \
         return null;",
        vec![],
    )
    .await?;
    let key = KeyActions::new("keys".into());
    page.actions(key.then(KeyAction::Down { value: 'q' }).then(KeyAction::Up { value: 'q' })).await?;
    page.eventually("a key", async || page.eval::<Option<Vec<String>>>("window.held ?? null").await).await
}

/// Leaves all of it: data, a held key, and every emulation.
async fn leave(page: &Session) -> Result<()> {
    page.before_scripts("window.left = 'behind';").await?;
    page.open("").await?;
    page.allow_clipboard().await?;
    page.js::<bool>(LEAVE, vec![]).await?;
    page.actions(KeyActions::new("keys".into()).then(KeyAction::Down { value: SHIFT })).await?;
    assert_eq!(held(page).await?, ["shiftKey"]);
    let features = json!([
        { "name": "prefers-color-scheme", "value": "dark" },
        { "name": "forced-colors", "value": "active" },
        { "name": "prefers-reduced-motion", "value": "reduce" },
    ]);
    for (method, parameters) in [
        ("Emulation.setEmulatedMedia", json!({ "media": "print", "features": features })),
        (
            "Emulation.setDeviceMetricsOverride",
            json!({ "width": 320, "height": 640, "deviceScaleFactor": 2, "mobile": true }),
        ),
        ("Emulation.setTouchEmulationEnabled", json!({ "enabled": true, "maxTouchPoints": 3 })),
        ("Emulation.setLocaleOverride", json!({ "locale": "ru-RU" })),
        ("Emulation.setTimezoneOverride", json!({ "timezoneId": "Asia/Tokyo" })),
        ("Emulation.setUserAgentOverride", json!({ "userAgent": "left behind", "acceptLanguage": "ru" })),
        ("Emulation.setHardwareConcurrencyOverride", json!({ "hardwareConcurrency": 1 })),
        ("Emulation.setCPUThrottlingRate", json!({ "rate": 2 })),
        ("Network.enable", json!({})),
        (
            "Network.emulateNetworkConditions",
            json!({ "offline": true, "latency": 0, "downloadThroughput": -1, "uploadThroughput": -1 }),
        ),
    ] {
        page.devtools(method, parameters).await?;
    }
    // It can be found: nothing is hidden from this test.
    let now: Found = page.js(FOUND, vec![]).await?;
    for (name, value) in [
        ("local storage", json!("behind")),
        ("session storage", json!("behind")),
        ("cookie", json!("left=behind")),
        ("databases", json!(["left"])),
        ("workers", json!(1)),
        ("clipboard", json!("granted")),
        ("script", json!("behind")),
        ("ratio", json!(2)),
        ("dark", json!(true)),
        ("forced colors", json!(true)),
        ("still", json!(true)),
        ("print", json!(true)),
        ("online", json!(false)),
        ("zone", json!("Asia/Tokyo")),
        ("agent", json!("left behind")),
        ("cores", json!(1)),
        ("touch", json!(3)),
    ] {
        ensure!(now.get(name) == Some(&value), "{name} is {:?}, not {value}", now.get(name));
    }
    Ok(())
}

#[test]
fn a_visitor_finds_nothing_of_the_previous_visitor() -> Result<()> {
    in_browser_that_keeps(|page| async move {
        let first = found(&page).await?;
        leave(&page).await?;
        page.js::<()>("console.error('left behind'); return null;", vec![]).await?;

        let (said, next) = page.bench.next_in_browser().await?;
        ensure!(
            said.len() == 1 && said[0].contains("left behind"),
            "the console's message is that of the first user: {said:?}"
        );
        ensure!(next.client.windows().await?.len() == 2, "a window is left open");
        assert_eq!(found(&next).await?, first);
        let complaints = next.complaints().await?;
        ensure!(complaints.is_empty(), "{complaints:?}");

        // The page works: it opens its default scenario and offers the guide.
        next.open("").await?;
        ensure!(next.visible("#welcome").await?, "the page knows the visitor");
        assert_eq!(held(&next).await?, [""; 0], "a key is held that this visitor never pressed");
        next.allow_clipboard().await?;
        assert_eq!(next.clipboard().await?, "");
        Ok(())
    })
}
