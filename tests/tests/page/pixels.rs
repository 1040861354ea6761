//! The contents of a canvas, read pixel by pixel.

use std::collections::BTreeMap;

use anyhow::{Result, ensure};
use serde::Deserialize;
use serde_json::json;

use crate::session::Session;

/// The current contents of a canvas.
#[derive(Debug, Deserialize)]
pub(crate) struct Canvas {
    /// Device pixels.
    pub(crate) width: f64,
    /// Device pixels.
    pub(crate) height: f64,
    /// Number of clearly different colors, without transparent pixels.
    pub(crate) colors: u32,
    /// A hash of all pixels; equal pictures have the same.
    pub(crate) hash: String,
    /// By the name of the color's custom property.
    pub(crate) inks: BTreeMap<String, Ink>,
}

/// Where one of the page's colors occurs to the right of the labels.
#[derive(Clone, Debug, Default, Deserialize)]
pub(crate) struct Ink {
    pub(crate) pixels: u32,
    /// Number of columns with it.
    pub(crate) columns: f64,
    /// Rows from the highest to the lowest.
    pub(crate) rows: f64,
}

/// Width of the label column; charts and pulses are to its right.
const LABELS_PX: f64 = 69.0;
/// Free space on the right of every plotting area.
const MARGIN_PX: f64 = 26.0;

impl Session {
    /// Reads a canvas.
    pub(crate) async fn canvas(&self, id: &str) -> Result<Canvas> {
        let inks = [
            "--ideal",
            "--actual",
            "--step",
            "--dir",
            "--enable",
            "--wire",
            "--packet",
            "--tick",
            "--cursor-a",
            "--cursor-b",
            "--baseline",
            "--accent",
        ];
        self.js(READ, vec![json!(id), json!(inks), json!(LABELS_PX)]).await
    }

    /// Reads the pulses with at most the row EN on its own background: it is the selected one.
    pub(crate) async fn pulses(&self) -> Result<Canvas> {
        self.choose("#edge-row", "32").await?;
        self.canvas("pulses").await
    }
}

impl Canvas {
    pub(crate) fn ink(&self, name: &str) -> Ink {
        self.inks.get(name).cloned().unwrap_or_default()
    }

    /// A curve in this color crosses the plotting area from left to right, over a large part of its height.
    pub(crate) fn has_curve(&self, name: &str) -> Result<()> {
        let ink = self.ink(name);
        let plot = self.width - LABELS_PX - MARGIN_PX;
        ensure!(ink.columns >= 0.9 * plot, "{name} has {} of {plot} columns", ink.columns);
        ensure!(ink.rows >= 0.4 * self.height, "{name} has {} of {} rows", ink.rows, self.height);
        Ok(())
    }
}

const READ: &str = "
    const [id, inks, labels] = arguments;
    const canvas = document.getElementById(id);
    const { width, height } = canvas;
    const { data } = canvas.getContext('2d').getImageData(0, 0, width, height);
    const style = getComputedStyle(document.documentElement);
    const found = Object.fromEntries(inks.map((name) => {
        const hex = parseInt(style.getPropertyValue(name).trim().slice(1), 16);
        return [name, { rgb: [hex >> 16, hex >> 8 & 255, hex & 255], pixels: 0, columns: new Set(), top: Infinity, low: -1 }];
    }));
    const colors = new Set();
    let hash = 0x811c9dc5;
    for (let at = 0; at < data.length; at += 4) {
        const [r, g, b, a] = [data[at], data[at + 1], data[at + 2], data[at + 3]];
        hash = Math.imul(hash ^ (r << 24 | g << 16 | b << 8 | a), 0x01000193) ^ hash >>> 15;
        if (a < 100) continue;
        colors.add(r >> 5 << 10 | g >> 5 << 5 | b >> 5);
        const x = at / 4 % width;
        if (x < labels) continue;
        for (const name of inks) {
            const ink = found[name];
            if (Math.abs(r - ink.rgb[0]) + Math.abs(g - ink.rgb[1]) + Math.abs(b - ink.rgb[2]) > 40) continue;
            const y = Math.floor(at / 4 / width);
            ink.pixels++;
            ink.columns.add(x);
            ink.top = Math.min(ink.top, y);
            ink.low = Math.max(ink.low, y);
        }
    }
    return { width, height, colors: colors.size, hash: String(hash >>> 0), inks: Object.fromEntries(inks.map((name) => {
        const { pixels, columns, top, low } = found[name];
        return [name, { pixels, columns: columns.size, rows: low < 0 ? 0 : low - top + 1 }];
    })) };";
