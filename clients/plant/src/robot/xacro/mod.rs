//! xacro: robots' files with macros, properties, conditions and expressions.
//!
//! Read is what robots are published with: properties (also as blocks, with `default` and `scope`),
//! macros with parameters, presets and blocks, `insert_block`, `include`, `if`, `unless`, `arg`, `call`;
//! `${…}` with the expressions of Python that make sense there, `load_yaml`, `$(find …)`, `$(arg …)`.
//! What is not understood is a fault; nothing is left out silently. The environment is never read.
//!
//! | module | subject |
//! |---|---|
//! | `value` | numbers, texts, lists, dictionaries |
//! | `expression`, `evaluate` | what stands between `${` and `}` |
//! | `arithmetic` | what operators make of two values |
//! | `names` | what an expression asks its surroundings for |
//! | `lists` | comprehensions and functions of lists |
//! | `yaml` | files of parameters |
//! | `scope` | what a name is worth where it is used |
//! | `parameter` | the parameters of a macro |
//!
//! Source: ROS wiki, xacro (the dialect since ROS Jade, which is that of ROS 2).

mod arithmetic;
mod evaluate;
mod expression;
mod lists;
mod names;
mod parameter;
mod scope;
mod value;
mod yaml;

use std::path::Path;
use std::sync::Arc;

use onescan_base::nearest;

use super::Reading;
use super::package;
use super::xml::{self, Attribute, Element, RobotFault};
use crate::file_place::Source;
use parameter::{Parameter, Preset};
use scope::{Property, Reach, Scope};
use value::Value;

/// Most elements of an expanded robot, and deepest nesting of macros and files.
const ELEMENTS_MAX: usize = 200_000;
const DEPTH_MAX: usize = 48;
/// Deepest nesting of elements, those of all open macros and files together.
const LEVELS_MAX: usize = 256;

#[derive(Debug)]
struct Macro {
    parameters: Vec<Parameter>,
    body: Vec<Element>,
}

/// A file's elements with everything of xacro's replaced by what it stands for.
///
/// # Errors
/// The first fault: what follows would be of no meaning.
pub(super) fn expand(root: &Element, path: &Path, reading: &Reading<'_>) -> Result<Element, RobotFault> {
    let given = reading.arguments.iter().map(|(name, text)| (name.clone(), Value::literal(text)));
    let scope = Scope::new(reading.packages, path, given.collect());
    let mut expander = Expander { scope, macros: Vec::new(), made: 0, depth: 0, levels: 0 };
    let children = expander.all(&root.children)?;
    Ok(Element { children, attributes: expander.attributes(root)?, ..bare(root) })
}

fn bare(element: &Element) -> Element {
    let Element { name, is_xacro, place, .. } = element;
    let (name, place) = (name.clone(), place.clone());
    Element { name, is_xacro: *is_xacro, attributes: Vec::new(), children: Vec::new(), place }
}

struct Expander<'r> {
    scope: Scope<'r>,
    macros: Vec<(String, Arc<Macro>)>,
    made: usize,
    depth: usize,
    levels: usize,
}

type Expanded = Result<Vec<Element>, RobotFault>;

impl Expander<'_> {
    fn all(&mut self, elements: &[Element]) -> Expanded {
        self.levels += 1;
        let expanded = self.level(elements);
        self.levels -= 1;
        expanded
    }

    fn level(&mut self, elements: &[Element]) -> Expanded {
        let mut expanded = Vec::new();
        for element in elements {
            if self.levels > LEVELS_MAX {
                return Err(element.wrong(format!("elements and macros are nested more than {LEVELS_MAX} deep")));
            }
            self.made += 1;
            if self.made > ELEMENTS_MAX {
                return Err(element.wrong(format!("the robot has more than {ELEMENTS_MAX} elements")));
            }
            if element.is_xacro {
                expanded.extend(self.own(element)?);
                continue;
            }
            let attributes = self.attributes(element)?;
            expanded.push(Element { attributes, children: self.all(&element.children)?, ..bare(element) });
        }
        Ok(expanded)
    }

    fn attributes(&mut self, element: &Element) -> Result<Vec<Attribute>, RobotFault> {
        let mut attributes = Vec::new();
        for attribute in &element.attributes {
            let value = self.value(attribute)?.to_string();
            attributes.push(Attribute { value, ..attribute.clone() });
        }
        Ok(attributes)
    }

    fn value(&mut self, attribute: &Attribute) -> Result<Value, RobotFault> {
        self.scope.text(&attribute.value).map_err(|cause| attribute.place.wrong(cause))
    }

    /// The value of an attribute that an element must have.
    fn needed(&mut self, element: &Element, key: &str) -> Result<Value, RobotFault> {
        let attribute = element.attribute(key);
        let attribute = attribute.ok_or_else(|| element.wrong(format!("<xacro:{}> needs `{key}`", element.name)))?;
        self.value(attribute)
    }

    /// What one of xacro's own elements stands for.
    fn own(&mut self, element: &Element) -> Expanded {
        match element.name.as_str() {
            "property" => self.property(element).map(|()| Vec::new()),
            "macro" => self.define(element).map(|()| Vec::new()),
            "arg" => self.argument(element).map(|()| Vec::new()),
            "include" => self.include(element),
            "if" | "unless" => {
                let value = self.needed(element, "value")?;
                let holds = value.condition();
                let wrong =
                    || element.wrong_at("value", format!("`{value}` is not a condition: true or false, 1 or 0"));
                let holds = holds.ok_or_else(wrong)?;
                if holds == (element.name == "if") { self.all(&element.children) } else { Ok(Vec::new()) }
            }
            "insert_block" => {
                let name = self.needed(element, "name")?.to_string();
                let block = self.scope.block(&format!("**{name}")).or_else(|| self.scope.block(&format!("*{name}")));
                let block = block.ok_or_else(|| element.wrong_at("name", format!("there is no block `{name}`")))?;
                self.nested(element, |this| this.all(&block))
            }
            "call" => {
                let name = self.needed(element, "macro")?.to_string();
                self.call(element, &name)
            }
            "element" | "attribute" => Err(element.wrong(format!("<xacro:{}> is not understood here", element.name))),
            name => self.call(element, name),
        }
    }

    fn nested(&mut self, at: &Element, inner: impl FnOnce(&mut Self) -> Expanded) -> Expanded {
        if self.depth == DEPTH_MAX {
            return Err(at.wrong(format!("macros and files are nested more than {DEPTH_MAX} deep")));
        }
        self.depth += 1;
        let expanded = inner(self);
        self.depth -= 1;
        expanded
    }

    fn property(&mut self, element: &Element) -> Result<(), RobotFault> {
        let name = self.needed(element, "name")?.to_string();
        let reach = match element.get("scope") {
            None | Some("local") => Reach::Here,
            Some("parent") => Reach::Parent,
            Some("global") => Reach::Global,
            Some(other) => {
                let wrong = element.wrong_at("scope", format!("a scope is `parent` or `global`, not `{other}`"));
                return Err(wrong);
            }
        };
        if self.flag(element, "remove", false)? {
            self.scope.remove(&name);
            return Ok(());
        }
        let (written, preset) = (element.attribute("value"), element.attribute("default"));
        if written.is_none() && preset.is_some() && self.scope.has(&name) {
            return Ok(());
        }
        let Some(text) = written.or(preset) else {
            let block = Property::Block(Arc::new(element.children.clone()));
            self.scope.set(&format!("**{name}"), block, reach);
            return Ok(());
        };
        let property = if reach == Reach::Here && self.flag(element, "lazy_eval", true)? {
            // what a property is written by its own former value is gone when somebody asks
            let value = if needs_now(&text.value, &name) { self.scope.text(&text.value).ok() } else { None };
            value.map_or_else(|| unasked(&text.value), |value| Property::Value(plain(value)))
        } else {
            Property::Value(plain(self.value(text)?))
        };
        self.scope.set(&name, property, reach);
        Ok(())
    }

    /// An attribute that is true or false.
    fn flag(&mut self, element: &Element, key: &str, preset: bool) -> Result<bool, RobotFault> {
        let Some(attribute) = element.attribute(key) else { return Ok(preset) };
        let value = self.value(attribute)?;
        let wrong = || attribute.place.wrong(format!("`{key}` must be true or false, not `{value}`"));
        value.condition().ok_or_else(wrong)
    }

    fn define(&mut self, element: &Element) -> Result<(), RobotFault> {
        let name = element.text("name")?;
        let name = name.strip_prefix("xacro:").unwrap_or(name).to_owned();
        let written = element.get("params").unwrap_or_default();
        let parameters = parameter::parse(written).map_err(|cause| element.wrong_at("params", cause))?;
        // the last definition holds
        self.macros.retain(|(known, _)| *known != name);
        self.macros.push((name, Arc::new(Macro { parameters, body: element.children.clone() })));
        Ok(())
    }

    fn argument(&mut self, element: &Element) -> Result<(), RobotFault> {
        let name = element.text("name")?.to_owned();
        if let Some(preset) = element.attribute("default")
            && !self.scope.arguments.iter().any(|(known, _)| *known == name)
        {
            let value = self.value(preset)?;
            self.scope.arguments.push((name, Value::literal(&value.to_string())));
        }
        Ok(())
    }

    fn include(&mut self, element: &Element) -> Expanded {
        let named = self.needed(element, "filename")?.to_string();
        if let Some(space) = element.attribute("ns") {
            return Err(space.place.wrong("`ns` of <xacro:include> is not understood here"));
        }
        let lost = |cause| element.wrong_at("filename", format!("names `{named}`, {cause}"));
        let path = self.scope.packages.file(&named, &self.scope.file).map_err(lost)?;
        let unread = |error| {
            let named = package::shown(Path::new(&named));
            element.wrong_at("filename", format!("`{named}` cannot be read: {error}"))
        };
        let text = self.scope.packages.read_text(&path).map_err(unread)?;
        let source = Arc::new(Source { file: package::shown(&path), text: text.into() });
        let root = xml::parse(&source)?;
        let before = std::mem::replace(&mut self.scope.file, path);
        let expanded = self.nested(element, |this| this.all(&root.children));
        self.scope.file = before;
        expanded
    }

    fn call(&mut self, element: &Element, name: &str) -> Expanded {
        let Some((_, called)) = self.macros.iter().find(|(known, _)| known == name) else {
            let wrong = element.wrong(format!("there is no macro `{name}`"));
            let near = nearest(name, self.macros.iter().map(|(known, _)| known.as_str()));
            return Err(match near {
                Some(near) => wrong.hinted(format!("did you mean `{near}`?")),
                None => wrong,
            });
        };
        let called = Arc::clone(called);
        let frame = self.frame(element, name, &called.parameters)?;
        self.scope.open(frame);
        let expanded = self.nested(element, |this| this.all(&called.body));
        self.scope.close();
        expanded
    }

    /// The parameters of a macro as one call gives them.
    fn frame(
        &mut self,
        element: &Element,
        name: &str,
        parameters: &[Parameter],
    ) -> Result<Vec<(String, Property)>, RobotFault> {
        let known = |key: &str| parameters.iter().any(|parameter| parameter.name == key && parameter.block.is_none());
        let foreign = element
            .attributes
            .iter()
            .find(|given| !(known(&given.key) || element.name == "call" && given.key == "macro"));
        if let Some(foreign) = foreign {
            let near = nearest(&foreign.key, parameters.iter().map(|parameter| parameter.name.as_str()));
            let wrong = foreign.place.wrong(format!("macro `{name}` has no parameter `{}`", foreign.key));
            return Err(match near {
                Some(near) => wrong.hinted(format!("did you mean `{near}`?")),
                None => wrong,
            });
        }
        let mut blocks = self.all(&element.children)?.into_iter();
        let mut frame = Vec::new();
        for parameter in parameters {
            let Parameter { name: key, block, preset } = parameter;
            if let Some(content) = block {
                let missing = || element.wrong(format!("macro `{name}` needs a block for `{key}`"));
                let given = blocks.next().ok_or_else(missing)?;
                let (mark, elements) = if *content { ("**", given.children) } else { ("*", vec![given]) };
                frame.push((format!("{mark}{key}"), Property::Block(Arc::new(elements))));
                continue;
            }
            let value = match (element.attribute(key), preset) {
                (Some(given), _) => self.value(given)?,
                (None, Some(preset)) => {
                    let reported = |cause| element.wrong(format!("parameter `{key}` of macro `{name}`: {cause}"));
                    self.preset(key, preset).map_err(reported)?
                }
                (None, None) => return Err(element.wrong(format!("macro `{name}` needs `{key}`"))),
            };
            frame.push((key.clone(), Property::Value(plain(value))));
        }
        match blocks.next() {
            None => Ok(frame),
            Some(extra) => Err(extra.wrong(format!("macro `{name}` takes no block <{}>", extra.name))),
        }
    }

    fn preset(&mut self, key: &str, preset: &Preset) -> Result<Value, String> {
        use names::Names as _;
        if preset.forwarded
            && let Some(value) = self.scope.value(key)?
        {
            return Ok(value);
        }
        match &preset.text {
            Some(text) => self.scope.text(text),
            None => Err(format!("there is no property `{key}` to take over")),
        }
    }
}

/// A property that is worth what its text says when somebody asks: what nobody asks for may be wrong.
fn unasked(text: &str) -> Property {
    match Value::literal(text) {
        Value::Text(inner) if inner.contains('$') => Property::Text(inner),
        value => Property::Value(value),
    }
}

/// A value that was written as a text.
fn plain(value: Value) -> Value {
    match value {
        Value::Text(text) => Value::literal(&text),
        other => other,
    }
}

/// Whether a property is written by its own former value.
fn needs_now(text: &str, name: &str) -> bool {
    text.match_indices("${").any(|(at, _)| {
        let behind = &text[at + 1..];
        scope::closing(behind, '{', '}').is_some_and(|end| expression::mentions(&behind[1..end], name))
    })
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use crate::robot::{Packages, Reading, Robot};

    fn links(inner: &str) -> Result<Vec<String>, String> {
        let text = format!("<robot xmlns:xacro=\"http://wiki.ros.org/xacro\">\n{inner}\n</robot>");
        let (packages, arguments) = (Packages::default(), [("given".to_owned(), "2".to_owned())]);
        let reading = Reading { file: "arm.xacro", packages: &packages, arguments: &arguments };
        let robot = Robot::read(Path::new("arm.xacro"), text, &reading).map_err(|faults| faults[0].to_string())?;
        Ok(robot.links.into_iter().map(|link| link.name).collect())
    }

    fn name_of(inner: &str) -> String {
        links(inner).map_or_else(|reported| reported, |links| links.concat())
    }

    #[test]
    fn properties_are_seen_where_ros_sees_them() {
        let cases = [
            // a property is worth what it says when somebody asks
            (
                r#"<xacro:property name="a" value="${b + 1}"/><xacro:property name="b" value="2"/><link name="l${a}"/>"#,
                "l3",
            ),
            (
                r#"<xacro:property name="a" value="1"/><xacro:property name="a" value="${a + 1}"/><link name="l${a}"/>"#,
                "l2",
            ),
            (
                r#"<xacro:property name="a" default="1"/><xacro:property name="a" default="2"/><link name="l${a}"/>"#,
                "l1",
            ),
            (
                r#"<xacro:arg name="given" default="7"/><xacro:arg name="other" default="x"/><link name="$(arg given)$(arg other)"/>"#,
                "2x",
            ),
            (
                r#"<xacro:macro name="m" params="a"><xacro:property name="b" value="${a}" scope="parent"/></xacro:macro>
                <xacro:m a="5"/><link name="l${b}"/>"#,
                "l5",
            ),
            (
                r#"<xacro:property name="a" value="out"/><xacro:macro name="m" params="b:=^|9 c:=${2*3} d:=''">
                <link name="${a}${b}${c}${d}"/></xacro:macro><xacro:m/>"#,
                "out96",
            ),
            (
                r#"<xacro:macro name="m" params="*one **many"><xacro:insert_block name="one"/><xacro:insert_block name="many"/>
                </xacro:macro><xacro:m><link name="a"/><g/></xacro:m>"#,
                "a",
            ),
            (
                r#"<xacro:unless value="${1 == 2}"><link name="yes"/></xacro:unless><xacro:if value="false"><link name="no"/></xacro:if>"#,
                "yes",
            ),
            (
                r#"<xacro:if value="${[1]}"><link name="yes"/></xacro:if><xacro:if value="${[]}"><link name="no"/></xacro:if>"#,
                "yes",
            ),
            (r#"<link name="a$${b}"/>"#, "a${b}"),
            (
                r#"<xacro:property name="a" value="1"/><xacro:macro name="m" params=""><xacro:property name="a" value="2" scope="local"/></xacro:macro>
                <xacro:m/><link name="l${a}"/>"#,
                "l1",
            ),
            // what nobody asks for may be wrong
            (
                r#"<xacro:property name="given" value="${arg given}"/><xacro:property name="b" value="${c}"/><link name="l"/>"#,
                "l",
            ),
            (
                r#"<xacro:property name="b" value="1"/><xacro:property name="a" value="${b}" lazy_eval="false"/>
                <xacro:property name="b" value="2"/><link name="l${a}"/>"#,
                "l1",
            ),
            (
                r#"<xacro:property name="a" value="1"/><xacro:property name="a" remove="true"/>
                <xacro:property name="${'a'}" default="2"/><link name="l${a}"/>"#,
                "l2",
            ),
            // a property whose name is a part of another's does not need itself
            (
                r#"<xacro:property name="a" value="${ab}"/><xacro:property name="ab" value="2"/><link name="l${a}"/>"#,
                "l2",
            ),
            (r#"<xacro:property name="l" value="${[1, 2]}"/><link name="${len(l)}${'_'}${l[1]}"/>"#, "2_2"),
        ];
        for (inner, name) in cases {
            assert_eq!(name_of(inner), name, "{inner}");
        }
    }

    #[test]
    fn what_has_no_end_is_reported() {
        let reported = |inner: &str| links(inner).expect_err("refused");
        let endless = r#"<xacro:macro name="m" params=""><xacro:m/></xacro:macro><xacro:m/>"#;
        assert!(reported(endless).contains("nested more than 48 deep"), "{}", reported(endless));
        let growing = r#"<xacro:macro name="m" params=""><a><a><a><a><a><a><a><a><xacro:m/></a></a></a></a></a></a></a></a></xacro:macro><xacro:m/>"#;
        assert!(reported(growing).contains("nested more than 256 deep"), "{}", reported(growing));
        let wide = r#"<xacro:macro name="m" params="n"><a/><a/><xacro:if value="${n > 0}"><xacro:m n="${n - 1}"/><xacro:m n="${n - 1}"/></xacro:if></xacro:macro><xacro:m n="40"/>"#;
        assert!(reported(wide).contains("more than 200000 elements"), "{}", reported(wide));
        assert!(
            reported(
                r#"<xacro:property name="a" value="${b}"/><xacro:property name="b" value="${a}"/><link name="${a}"/>"#
            )
            .ends_with("property `a`: property `b`: `a` needs itself by way of `b`")
        );
        assert!(reported(r#"<link name="$(env HOME)"/>"#).contains("does not depend on the environment"));
        let loops = r#"<link name="${len([[b for b in range(9999)] for a in range(9999)])}"/>"#;
        assert!(reported(loops).ends_with("lists have more than 1000000 values and letters"), "{}", reported(loops));
        let used = r#"<xacro:property name="a" value="${arg b}"/><link name="${a}"/>"#;
        assert!(reported(used).contains("property `a`: `arg b` is not an expression"), "{}", reported(used));
        let used = r#"<xacro:property name="a" value="${b}"/><link name="${a}"/>"#;
        assert!(reported(used).ends_with("property `a`: there is no property `b`"), "{}", reported(used));
        assert!(reported(r#"<link name="${1"/>"#).contains("has no end"));
        assert!(reported(r#"<xacro:include filename="arm.xacro"/>"#).contains("cannot be read"));
        assert!(reported(r#"<xacro:element xacro:name="a"/>"#).contains("is not understood here"));
    }
}
