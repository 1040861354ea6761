//! The three browser engines: drivers, options of sessions, and consoles.

use std::{env, ffi::OsString, net::TcpListener, path::Path, process::Command};

use anyhow::{Context, Result, bail};
use serde_json::{Map, Value, json};

/// Options of every Chromium: no window, and no requests to other hosts.
const FLAGS: &[&str] = &[
    "--headless",
    // The browser ends when the driver does.
    "--remote-debugging-pipe",
    "--no-sandbox",
    "--disable-gpu",
    "--disable-quic",
    "--no-first-run",
    // A browser has one user after another, so their pages need no separate processes.
    "--renderer-process-limit=1",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--disable-dev-shm-usage",
    "--force-device-scale-factor=1",
    "--window-size=1440,900",
    "--host-resolver-rules=MAP *.localhost 127.0.0.1, MAP * ~NOTFOUND, EXCLUDE 127.0.0.1",
];

/// A browser engine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Browser {
    /// All tests run here, in shared browsers.
    Chromium,
    /// Without a window, like Chromium.
    Firefox,
    /// WebKitGTK's MiniBrowser, which needs a display.
    WebKit,
}

/// How a driver reports its address.
pub(crate) enum Says {
    /// In the line with this text, followed by the address or the port.
    Line(&'static str),
    /// In the line with this text, followed by a path.
    Path(&'static str),
    /// Not at all: it was given this port.
    Nothing(u16),
}

impl Browser {
    /// The command of the driver.
    pub(crate) fn driver(self) -> Result<(Command, Says)> {
        let variable = match self {
            Self::Chromium => "STEPSCOPE_CHROMEDRIVER",
            Self::Firefox => "STEPSCOPE_GECKODRIVER",
            Self::WebKit => "STEPSCOPE_WEBKITDRIVER",
        };
        let mut command = Command::new(named(variable)?);
        let says = match self {
            Self::Chromium => {
                command.arg("--port=0");
                Says::Line("started successfully on port ")
            }
            Self::Firefox => {
                command.args(["--port", "0"]);
                Says::Line("Listening on 127.0.0.1:")
            }
            Self::WebKit => {
                named("DISPLAY").context("WebKit draws on a display only")?;
                // It does not accept port 0. The listener is closed here, so that the driver can use its port.
                let port = TcpListener::bind("127.0.0.1:0")?.local_addr()?.port();
                command.args(["--host=127.0.0.1", &format!("--port={port}")]);
                Says::Nothing(port)
            }
        };
        Ok((command, says))
    }

    /// Options of a new session. Its profile is new, in the folder for the driver's temporary files.
    pub(crate) fn capabilities(self) -> Result<Map<String, Value>> {
        let wanted = match self {
            Self::Chromium => json!({
                "browserName": "chrome",
                "goog:loggingPrefs": { "browser": "ALL" },
                "goog:chromeOptions": { "binary": Path::new(&named("STEPSCOPE_CHROMIUM")?), "args": FLAGS },
            }),
            Self::Firefox => json!({
                "browserName": "firefox",
                "moz:firefoxOptions": {
                    "binary": Path::new(&named("STEPSCOPE_FIREFOX")?),
                    "args": ["-headless"],
                    "prefs": { "network.dns.disabled": true, "browser.dom.window.dump.enabled": true },
                },
            }),
            // The driver finds its own browser.
            Self::WebKit => json!({}),
        };
        let Value::Object(wanted) = wanted else { bail!("the capabilities are an object") };
        Ok(wanted)
    }

    /// Whether a line of the driver's output is an error of a page at this address.
    pub(crate) fn complains(self, line: &str, page: &str) -> bool {
        self == Self::Firefox && line.starts_with(&format!("JavaScript error: {page}"))
    }
}

/// The value of an environment variable that `cargo xtask test` sets.
pub(crate) fn named(variable: &str) -> Result<OsString> {
    env::var_os(variable).with_context(|| {
        format!(
            "{variable} is not set; `cargo xtask test --only page --only engines` sets what these tests need"
        )
    })
}
