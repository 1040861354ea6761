//! One browser with the page: the actions of a user, and what is visible.

use std::{env, fs, path::Path, sync::Arc, time::Duration};

use anyhow::{Context, Result, ensure};
use fantoccini::{Client, Locator, elements::Element};
use serde::{Deserialize, de::DeserializeOwned};
use serde_json::{Map, Value, json};
use tokio::time::{Instant, sleep};

use crate::bench::Bench;

/// Maximum time to wait, on a busy machine, too.
const PATIENCE: Duration = Duration::from_secs(300);
/// Pause between two checks.
const LOOK_AGAIN: Duration = Duration::from_millis(20);

/// A user's browser.
#[derive(Clone)]
pub(crate) struct Session {
    pub(crate) client: Client,
    pub(crate) bench: Arc<Bench>,
    address: String,
}

/// One field of the form, as a user or a screen reader reads it.
#[derive(Debug, Deserialize, PartialEq)]
pub(crate) struct Field {
    pub(crate) value: String,
    /// `aria-invalid`.
    pub(crate) invalid: bool,
    /// The visible error next to it; empty without one.
    pub(crate) error: String,
    /// All texts of `aria-describedby`.
    pub(crate) described: String,
}

/// The header's text on the visible run.
#[derive(Debug, Deserialize, PartialEq)]
pub(crate) struct Shown {
    pub(crate) ready: bool,
    pub(crate) digest: String,
    /// The digest belongs to an earlier scenario.
    pub(crate) stale: bool,
}

impl Session {
    pub(crate) fn new(client: Client, bench: &Arc<Bench>, address: String) -> Self {
        Self { client, bench: Arc::clone(bench), address }
    }

    /// Another user: at the same address in a new second browser.
    pub(crate) async fn stranger(&self) -> Result<Self> {
        self.bench.visitor(Some(self.address.clone())).await
    }

    /// Goes to another page of the site.
    pub(crate) async fn go(&self, path: &str) -> Result<()> {
        Ok(self.client.goto(&format!("{}{path}", self.address())).await?)
    }

    /// Another user, if a driver has one browser at a time: the current user leaves, with an empty console.
    pub(crate) async fn next_visitor(&self) -> Result<Self> {
        let (said, next) = self.bench.next_in_browser().await?;
        ensure!(said.is_empty(), "the console is not silent:\n{}", said.join("\n"));
        Ok(next)
    }

    /// Address of the page, without a fragment.
    pub(crate) fn address(&self) -> &str {
        &self.address
    }

    /// Loads the page again, with or without a fragment, without waiting for it.
    pub(crate) async fn load(&self, fragment: &str) -> Result<()> {
        // Changing only the fragment loads nothing.
        self.client.goto("about:blank").await?;
        self.client.goto(&format!("{}{fragment}", self.address())).await?;
        self.listen().await
    }

    /// Loads the page again and waits until it is ready.
    pub(crate) async fn open(&self, fragment: &str) -> Result<()> {
        self.load(fragment).await?;
        self.ready().await
    }

    /// Opens a link by changing the address of the open page, without reloading it.
    pub(crate) async fn follow(&self, fragment: &str) -> Result<()> {
        self.js::<()>("location.hash = arguments[0]; return null;", vec![json!(fragment)]).await
    }

    /// Runs a script in the page.
    pub(crate) async fn js<T: DeserializeOwned>(&self, script: &str, arguments: Vec<Value>) -> Result<T> {
        let answer = self.client.execute(script, arguments).await.with_context(|| script.to_owned())?;
        serde_json::from_value(answer.clone()).with_context(|| format!("{script} gave {answer}"))
    }

    /// The value of an expression in the page.
    pub(crate) async fn eval<T: DeserializeOwned>(&self, expression: &str) -> Result<T> {
        self.js(&format!("return {expression};"), Vec::new()).await
    }

    /// Waits until an expression in the page is true.
    pub(crate) async fn until(&self, expression: &str) -> Result<()> {
        self.until_equal(&format!("Boolean({expression})"), &json!(true)).await
    }

    /// Waits until an expression in the page has a value; an error states the last one.
    pub(crate) async fn until_equal(&self, expression: &str, wanted: &Value) -> Result<()> {
        let end = Instant::now() + PATIENCE;
        loop {
            let found: Value = self.eval(expression).await?;
            if found == *wanted {
                return Ok(());
            }
            ensure!(
                Instant::now() < end,
                "{expression} is still {found} after {PATIENCE:?}, wanted {wanted}"
            );
            sleep(LOOK_AGAIN).await;
        }
    }

    /// Checks repeatedly until there is a value.
    pub(crate) async fn eventually<T>(
        &self,
        what: &str,
        look: impl AsyncFn() -> Result<Option<T>>,
    ) -> Result<T> {
        let end = Instant::now() + PATIENCE;
        loop {
            if let Some(seen) = look().await? {
                return Ok(seen);
            }
            ensure!(Instant::now() < end, "{what}: not after {PATIENCE:?}");
            sleep(LOOK_AGAIN).await;
        }
    }

    /// Waits until no more results are pending.
    pub(crate) async fn ready(&self) -> Result<()> {
        self.until("document.documentElement.dataset.state === 'ready'").await
    }

    pub(crate) async fn shown(&self) -> Result<Shown> {
        self.eval(SHOWN).await
    }

    /// Waits until the page is ready and shows the result of the scenario with this digest.
    pub(crate) async fn until_digest(&self, digest: &str) -> Result<()> {
        let wanted = json!({ "ready": true, "digest": digest, "stale": false });
        self.until_equal(SHOWN, &wanted).await
    }

    /// Visible text of an element; empty if it is hidden.
    pub(crate) async fn text(&self, css: &str) -> Result<String> {
        Ok(self.find(css).await?.text().await?)
    }

    pub(crate) async fn find(&self, css: &str) -> Result<Element> {
        self.client.find(Locator::Css(css)).await.with_context(|| format!("the page has no {css}"))
    }

    pub(crate) async fn visible(&self, css: &str) -> Result<bool> {
        Ok(self.find(css).await?.is_displayed().await?)
    }

    pub(crate) async fn click(&self, css: &str) -> Result<()> {
        self.find(css).await?.click().await.with_context(|| format!("{css} can't be clicked"))
    }

    /// Expands the spectrum if it is collapsed, because the motion is not periodic.
    pub(crate) async fn unfold_spectrum(&self) -> Result<()> {
        if !self.visible("#spectrum-chart").await? {
            self.click("#view-spectrum .fold").await?;
        }
        self.until("document.getElementById('spectrum-reading').checkVisibility()").await
    }

    /// Focuses an element and types.
    pub(crate) async fn press(&self, css: &str, keys: &str) -> Result<()> {
        let element = self.find(css).await?;
        self.js::<Value>("arguments[0].focus();", vec![serde_json::to_value(&element)?]).await?;
        element.send_keys(keys).await.with_context(|| format!("{css} takes no keys"))
    }

    /// Replaces the text of the field of a path in the scenario, by keys.
    pub(crate) async fn fill(&self, path: &str, text: &str) -> Result<()> {
        self.unfold(path).await?;
        let field = self.find(&field(path)).await?;
        field.click().await?;
        // Held keys are released at the end of a command; not every driver can release them within one.
        field.send_keys(&format!("{CONTROL}a")).await?;
        Ok(field.send_keys(text).await?)
    }

    /// Selects an option of the field of a path, like a user's click.
    pub(crate) async fn choose(&self, css: &str, value: &str) -> Result<()> {
        // An added part has its fields after the page has drawn it.
        self.until(&format!("document.querySelector({})", json!(css))).await?;
        self.find(css).await?.select_by_value(value).await.with_context(|| format!("{css} has no {value}"))
    }

    /// Opens a preset, a sample recording (by `id`) or a saved experiment (`own:` and its title) from the gallery.
    pub(crate) async fn preset(&self, id: &str) -> Result<()> {
        self.click("#preset").await?;
        let card = format!("#gallery[open] [data-entry=\"{id}\"]");
        self.until(&format!("document.querySelector('{card}')")).await?;
        self.click(&card).await
    }

    /// Opens the sections around a field and scrolls to it: a field that the form's edge cuts off can't be clicked.
    async fn unfold(&self, path: &str) -> Result<()> {
        let script = "for (let at = document.querySelector(arguments[0]); at; at = at.parentElement) \
                      if (at instanceof HTMLDetailsElement) at.open = true; \
                      document.querySelector(arguments[0])?.scrollIntoView({ block: 'center' }); return true;";
        self.js::<bool>(script, vec![json!(field(path))]).await.map(drop)
    }

    pub(crate) async fn field(&self, path: &str) -> Result<Field> {
        self.unfold(path).await?;
        self.js(FIELD, vec![json!(field(path))]).await
    }

    /// Text of every field by its path: the whole form.
    pub(crate) async fn form(&self) -> Result<Map<String, Value>> {
        self.eval(
            "Object.fromEntries([...document.querySelectorAll('#fields [data-path]')].map((node) => \
             [node.dataset.path, node.value]))",
        )
        .await
    }

    /// The derived value with this name, such as `Peak rate`.
    pub(crate) async fn derived(&self, name: &str) -> Result<String> {
        let script = "const term = [...document.querySelectorAll('#derived dt')].find((each) => \
                      each.textContent === arguments[0]); return term ? term.nextElementSibling.textContent : null;";
        let value: Option<String> = self.js(script, vec![json!(name)]).await?;
        value.with_context(|| format!("nothing is derived that is called {name}"))
    }

    pub(crate) async fn actions(&self, actions: impl Into<fantoccini::actions::Actions>) -> Result<()> {
        Ok(self.client.perform_actions(actions).await?)
    }

    /// Saves a picture of the page if pictures are requested.
    pub(crate) async fn picture(&self, name: &str) -> Result<()> {
        let Some(folder) = env::var_os("STEPSCOPE_SHOTS") else { return Ok(()) };
        fs::create_dir_all(&folder)?;
        let picture = self.client.screenshot().await?;
        Ok(fs::write(Path::new(&folder).join(format!("{name}.png")), picture)?)
    }

    /// Saves the last picture of a failed test.
    pub(crate) async fn failed(&self) {
        let name = std::thread::current().name().unwrap_or("page").replace("::", "-");
        // The test has already failed, for a more important reason.
        let _ = tokio::time::timeout(PATIENCE, self.picture(&format!("failed-{name}"))).await;
    }

    pub(crate) async fn end(self) -> Result<()> {
        Ok(self.client.close().await?)
    }
}

/// The visible time in s, from the fields of the pulses.
pub(crate) const WINDOW_S: &str = "['window-start', 'window-end'].map((id) => {
    const [number, unit] = document.getElementById(id).value.split(/\\s/);
    return Number(number) * { s: 1, ms: 1e-3, 'µs': 1e-6 }[unit];
})";

/// Keys in the notation of WebDriver.
pub(crate) const CONTROL: char = '\u{e009}';
/// See [`CONTROL`].
pub(crate) const SHIFT: char = '\u{e008}';
/// See [`CONTROL`].
pub(crate) const ALT: char = '\u{e00a}';
/// Releases the held keys.
pub(crate) const RELEASE: char = '\u{e000}';
/// See [`CONTROL`].
pub(crate) const ENTER: char = '\u{e007}';
/// See [`CONTROL`].
pub(crate) const END: char = '\u{e010}';

/// Selector of the field of a path.
pub(crate) fn field(path: &str) -> String {
    format!("[data-path=\"{path}\"]")
}

const SHOWN: &str = "{ ready: document.documentElement.dataset.state === 'ready', \
     digest: document.getElementById('digest').textContent, \
     stale: document.getElementById('digest').classList.contains('stale') }";

const FIELD: &str = "
    const node = document.querySelector(arguments[0]);
    const error = node.closest('.field').querySelector('.error');
    const ids = (node.getAttribute('aria-describedby') ?? '').split(/\\s+/).filter(Boolean);
    return {
        value: node.value,
        invalid: node.getAttribute('aria-invalid') === 'true',
        error: error.checkVisibility() ? error.textContent : '',
        described: ids.map((id) => document.getElementById(id).textContent).join(' '),
    };";
