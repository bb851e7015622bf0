//! Layouts that PlotJuggler and Foxglove open beside a trace: a plot for each joint, the residuals on a tab of their own.

use datasets::write::Curves;
use report::xml::attribute;
use serde_json::{Map, Value, json};
use std::path::{Path, PathBuf};

/// Title of each tab, with its curves and their colours, which people tell apart who do not see red and green, on light and on dark.
const TABS: [(&str, &[(&str, &str)]); 2] = [
    (
        "torque",
        &[
            ("measured", "#b7791f"),
            ("as_given", "#9aa3ae"),
            ("corrected", "#0b6bcb"),
        ],
    ),
    ("what is left", &[("residual", "#7b4fbf")]),
];

/// Paths of the layouts of a trace: of an MCAP, since names of curves are another file's otherwise.
pub fn paths(trace: &Path) -> Vec<PathBuf> {
    let ending = trace.extension().and_then(|e| e.to_str());
    if !ending.is_some_and(|e| e.eq_ignore_ascii_case("mcap")) {
        return Vec::new();
    }
    ["plotjuggler.xml", "foxglove.json"]
        .map(|e| trace.with_extension(e))
        .to_vec()
}

/// Path and text of each layout.
pub(crate) fn files(curves: &Curves, trace: &Path) -> Vec<(PathBuf, String)> {
    let joints: Vec<&str> = curves
        .groups
        .iter()
        .map(|(name, _)| name.as_str())
        .collect();
    let name = trace.file_name().unwrap_or_default().to_string_lossy();
    let texts = [
        plotjuggler(curves.topic, &joints, &name),
        foxglove(curves.topic, &joints),
    ];
    paths(trace).into_iter().zip(texts).collect()
}

/// PlotJuggler's: opening it loads the trace, which lies in the same folder.
fn plotjuggler(topic: &str, joints: &[&str], trace: &str) -> String {
    let topic = attribute(topic);
    let height = 1.0 / joints.len().max(1) as f64;
    let sizes = vec![format!("{height:.6}"); joints.len()].join(";");
    let mut out = String::from("<?xml version='1.0' encoding='UTF-8'?>\n<root>\n");
    out += " <tabbed_widget name=\"Main Window\" parent=\"main_window\">\n";
    for (title, curves) in TABS {
        out += &format!("  <Tab tab_name=\"{title}\" containers=\"1\">\n   <Container>\n");
        let count = joints.len();
        out +=
            &format!("    <DockSplitter orientation=\"-\" count=\"{count}\" sizes=\"{sizes}\">\n");
        for joint in joints.iter().map(|j| attribute(j)) {
            out += &format!("     <DockArea name=\"{joint}\">\n");
            out += "      <plot mode=\"TimeSeries\" style=\"Lines\" flip_x=\"false\" flip_y=\"false\">\n";
            for (curve, colour) in curves {
                out += &format!(
                    "       <curve name=\"/{topic}/{joint}/{curve}\" color=\"{colour}\"/>\n"
                );
            }
            out += "      </plot>\n     </DockArea>\n";
        }
        out += "    </DockSplitter>\n   </Container>\n  </Tab>\n";
    }
    out += "  <currentTabIndex index=\"0\"/>\n </tabbed_widget>\n <use_relative_time_offset enabled=\"1\"/>\n";
    let trace = attribute(trace);
    out +=
        &format!(" <previouslyLoaded_Datafiles>\n  <fileInfo prefix=\"\" filename=\"{trace}\">\n");
    out += &format!(
        "   <selected_datasources value=\"/{topic}\"/>\n   <plugin ID=\"DataLoad MCAP\">\n"
    );
    out += &format!(
        "    <parameters max_array_size=\"500\" use_timestamp=\"0\" clamp_large_arrays=\"1\" selected_topics=\"/{topic}\"/>\n"
    );
    out + "   </plugin>\n  </fileInfo>\n </previouslyLoaded_Datafiles>\n</root>\n"
}

/// Foxglove's, and Lichtblick's.
fn foxglove(topic: &str, joints: &[&str]) -> String {
    let mut panels = Map::new();
    let mut tabs = Vec::new();
    for (number, (title, curves)) in TABS.into_iter().enumerate() {
        let mut ids = Vec::new();
        for (j, joint) in joints.iter().enumerate() {
            let paths: Vec<Value> = curves
                .iter()
                .map(|(curve, colour)| {
                    let path = format!("/{topic}.{}.{curve}", quoted(joint));
                    json!({"value": path, "label": curve, "color": colour, "enabled": true, "timestampMethod": "receiveTime"})
                })
                .collect();
            let id = format!("Plot!{number}-{j}");
            let plot = json!({
                "foxglovePanelTitle": joint, "paths": paths, "xAxisVal": "timestamp", "isSynced": true, "showXAxisLabels": true,
                "showYAxisLabels": true, "showLegend": true, "legendDisplay": "floating", "showPlotValuesInLegend": false,
                "sidebarDimension": 240,
            });
            panels.insert(id.clone(), plot);
            ids.push(id);
        }
        tabs.push(json!({"title": title, "layout": stacked(&ids)}));
    }
    panels.insert(
        "Tab!torque".to_owned(),
        json!({"activeTabIdx": 0, "tabs": tabs}),
    );
    let layout = json!({
        "configById": panels, "globalVariables": {}, "userNodes": {}, "playbackConfig": {"speed": 1}, "layout": "Tab!torque",
    });
    format!("{layout:#}\n")
}

/// Panels below each other, all as high.
fn stacked(ids: &[String]) -> Value {
    match ids {
        [] => Value::Null,
        [one] => json!(one),
        [first, rest @ ..] => {
            json!({"direction": "column", "first": first, "second": stacked(rest), "splitPercentage": 100.0 / ids.len() as f64})
        }
    }
}

/// Name of a field in a message path: in quotes where it is more than letters, digits and underscores.
fn quoted(name: &str) -> String {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '_';
    if !name.is_empty() && name.chars().all(bare) {
        return name.to_owned();
    }
    format!("\"{}\"", name.replace('\\', "\\\\").replace('"', "\\\""))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_every_kind_stand_in_both_layouts() {
        let joints = ["elbow", "left/arm-1", "a \"b\" <c>"];
        let xml = plotjuggler("torque", &joints, "gap.mcap");
        let tree = roxmltree::Document::parse(&xml).expect("XML");
        let names: Vec<&str> = tree
            .descendants()
            .filter(|n| n.has_tag_name("curve"))
            .filter_map(|n| n.attribute("name"))
            .collect();
        assert_eq!(names.len(), 12);
        assert_eq!(names[3], "/torque/left/arm-1/measured");
        assert_eq!(names[11], "/torque/a \"b\" <c>/residual");
        let text = foxglove("torque", &joints);
        let layout: Value = serde_json::from_str(&text).expect("JSON");
        let path = |id: &str, k: usize| layout["configById"][id]["paths"][k]["value"].clone();
        assert_eq!(path("Plot!0-0", 2), "/torque.elbow.corrected");
        assert_eq!(path("Plot!0-1", 0), "/torque.\"left/arm-1\".measured");
        assert_eq!(path("Plot!1-2", 0), "/torque.\"a \\\"b\\\" <c>\".residual");
        let first = &layout["configById"]["Tab!torque"]["tabs"][0]["layout"];
        assert_eq!(first["second"]["first"], "Plot!0-1");
        assert_eq!(first["second"]["splitPercentage"], 50.0);
    }

    #[test]
    fn only_an_mcap_has_layouts() {
        assert!(paths(Path::new("gap.parquet")).is_empty());
        let beside = paths(Path::new("out/gap.MCAP"));
        assert_eq!(beside[0], Path::new("out/gap.plotjuggler.xml"));
        assert_eq!(beside[1], Path::new("out/gap.foxglove.json"));
    }
}
