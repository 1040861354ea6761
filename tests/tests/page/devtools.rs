//! Functions beyond WebDriver: Chromium by the DevTools protocol, the other browsers as far as possible.

use anyhow::{Result, bail};
use fantoccini::{Client, error::CmdError, wd::WebDriverCompatibleCommand};
use http::Method;
use serde_json::{Value, json};
use url::{ParseError, Url};

use crate::{browser::Browser, session::Session};

impl Session {
    /// Size of the viewport in CSS pixels.
    pub(crate) async fn screen(&self, width: u32, height: u32) -> Result<()> {
        if self.bench.browser != Browser::Chromium {
            return self.window(width, height).await;
        }
        let size = json!({ "width": width, "height": height, "deviceScaleFactor": 1, "mobile": false });
        self.devtools("Emulation.setDeviceMetricsOverride", size).await.map(drop)
    }

    /// The same, if only the window can be sized: its frame is measured first.
    async fn window(&self, width: u32, height: u32) -> Result<()> {
        self.client.set_window_size(width, height).await?;
        let inside: (u32, u32) = self.eval("[innerWidth, innerHeight]").await?;
        let frame = (width.saturating_sub(inside.0), height.saturating_sub(inside.1));
        Ok(self.client.set_window_size(width + frame.0, height + frame.1).await?)
    }

    /// The color scheme of the system, `light` or `dark`.
    pub(crate) async fn system_colors(&self, scheme: &str) -> Result<()> {
        let features = json!({ "features": [{ "name": "prefers-color-scheme", "value": scheme }] });
        self.devtools("Emulation.setEmulatedMedia", features).await.map(drop)
    }

    /// A script that runs in each later document, before its own scripts.
    pub(crate) async fn before_scripts(&self, source: &str) -> Result<()> {
        self.devtools("Page.addScriptToEvaluateOnNewDocument", json!({ "source": source })).await.map(drop)
    }

    /// A command of the Chrome DevTools protocol.
    pub(crate) async fn devtools(&self, method: &str, parameters: Value) -> Result<Value> {
        command(&self.client, method, parameters).await
    }

    /// Allows the current page to read and write the clipboard, and empties it.
    pub(crate) async fn allow_clipboard(&self) -> Result<()> {
        let origin = self.address().trim_end_matches('/');
        let permissions = ["clipboardReadWrite", "clipboardSanitizedWrite"];
        self.devtools("Browser.grantPermissions", json!({ "origin": origin, "permissions": permissions }))
            .await?;
        self.js::<()>("return navigator.clipboard.writeText('').then(() => null);", Vec::new()).await
    }

    pub(crate) async fn clipboard(&self) -> Result<String> {
        self.js("return navigator.clipboard.readText();", Vec::new()).await
    }

    /// Errors in the browser's console: exceptions, refused loads, breaches of the content security policy.
    /// Chromium reports all of them, Firefox the exceptions; for WebKit, and for refused loads of the others, they are
    /// collected from the end of loading on.
    pub(crate) async fn complaints(&self) -> Result<Vec<String>> {
        if self.bench.browser != Browser::Chromium {
            let mut heard: Vec<String> = self.eval("window.heard ?? []").await?;
            let said = self.bench.heard();
            heard.extend(said.into_iter().filter(|line| self.bench.browser.complains(line, self.address())));
            return Ok(heard);
        }
        let entries = console(&self.client).await?;
        let severe = entries.iter().filter(|entry| entry["level"] == "SEVERE");
        Ok(severe.map(|entry| entry["message"].to_string()).collect())
    }

    /// Collects the errors of the loaded page, if the browser does not report them.
    pub(crate) async fn listen(&self) -> Result<()> {
        if self.bench.browser == Browser::Chromium {
            Ok(())
        } else {
            self.js::<bool>(LISTEN, Vec::new()).await.map(drop)
        }
    }
}

/// A command of the Chrome DevTools protocol to the visible tab.
pub(crate) async fn command(client: &Client, method: &str, parameters: Value) -> Result<Value> {
    let body = json!({ "cmd": method, "params": parameters });
    Ok(chrome(client, "goog/cdp/execute", body).await?)
}

/// New messages of Chromium's console.
pub(crate) async fn console(client: &Client) -> Result<Vec<Value>> {
    match chrome(client, "se/log", json!({ "type": "browser" })).await? {
        Value::Array(entries) => Ok(entries),
        other => bail!("the console gave {other}"),
    }
}

async fn chrome(client: &Client, place: &'static str, body: Value) -> Result<Value, CmdError> {
    client.issue_cmd(ChromeCommand { place, body }).await
}

const LISTEN: &str = "
    window.heard = [];
    const say = (text) => window.heard.push(String(text));
    addEventListener('error', (event) => say(event.message ?? event.target?.src));
    addEventListener('unhandledrejection', (event) => say(event.reason));
    document.addEventListener('securitypolicyviolation', (event) => say(`${event.violatedDirective}: ${event.blockedURI}`));
    return true;";

/// A command of chromedriver only.
#[derive(Debug)]
struct ChromeCommand {
    place: &'static str,
    body: Value,
}

impl WebDriverCompatibleCommand for ChromeCommand {
    fn endpoint(&self, base: &Url, session: Option<&str>) -> Result<Url, ParseError> {
        base.join(&format!("session/{}/{}", session.unwrap_or_default(), self.place))
    }

    fn method_and_body(&self, _: &Url) -> (Method, Option<String>) {
        (Method::POST, Some(self.body.to_string()))
    }
}
