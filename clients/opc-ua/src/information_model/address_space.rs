//! Nodes in a server.

use opcua::nodes::{DataTypeBuilder, MethodBuilder, ObjectBuilder, ObjectTypeBuilder, VariableBuilder};
use opcua::server::address_space::AddressSpace;
use opcua::types::{
    Argument as UaArgument, DataTypeDefinition, EnumDefinition, EnumField, ExtensionObject, LocalizedText, NodeId,
    QualifiedName, ReferenceTypeId, UAString, Variant, VariantScalarTypeId,
};

use super::node::{Argument, Id, Kind, Node, Relation, Rule, Space, Value};

/// What the namespaces of the model are in this server.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Namespaces {
    pub types: u16,
    pub session: u16,
}

const MANDATORY: u32 = 78;
const OPTIONAL_PLACEHOLDER: u32 = 11508;
/// A value without dimensions, and one with one (OPC 10000-3 5.6.2).
const SCALAR: i32 = -1;
const LIST: i32 = 1;

impl Namespaces {
    /// The node id of `id` in this server.
    pub fn node_id(self, id: &Id) -> NodeId {
        match id {
            Id::Core(number) => NodeId::new(0, *number),
            Id::Type(number) => NodeId::new(self.types, *number),
            Id::Instance(path) => NodeId::new(self.session, path.clone()),
        }
    }

    fn browse_name(self, node: &Node) -> QualifiedName {
        let index = match node.space {
            Space::Core => 0,
            Space::Types => self.types,
            Space::Session => self.session,
        };
        QualifiedName::new(index, node.name.as_str())
    }

    /// Adds `node`, with the references to its parent, its type and its rule.
    pub fn insert(self, space: &mut AddressSpace, node: &Node) {
        let id = self.node_id(&node.id);
        let (name, shown, about) =
            (self.browse_name(node), LocalizedText::from(node.name.as_str()), LocalizedText::from(node.about.as_str()));
        match &node.kind {
            Kind::ObjectType => {
                ObjectTypeBuilder::new(&id, name, shown).description(about).insert(space);
            }
            Kind::Enumeration(fields) => {
                let definition = DataTypeDefinition::Enum(EnumDefinition { fields: Some(enum_fields(fields)) });
                let builder = DataTypeBuilder::new(&id, name, shown).description(about);
                builder.data_type_definition(definition).insert(space);
            }
            Kind::Object { of } => {
                let builder = ObjectBuilder::new(&id, name, shown).description(about);
                builder.has_type_definition(self.node_id(of)).insert(space);
            }
            Kind::Variable { of, data_type, is_array, is_writable, value } => {
                let builder = VariableBuilder::new(&id, name, shown)
                    .description(about)
                    .data_type(self.node_id(data_type))
                    .value_rank(if *is_array { LIST } else { SCALAR })
                    .value(variant(*value))
                    .minimum_sampling_interval(0.0)
                    .has_type_definition(NodeId::new(0, *of));
                if *is_writable { builder.writable() } else { builder }.insert(space);
            }
            Kind::Method => {
                MethodBuilder::new(&id, name, shown)
                    .description(about)
                    .executable(true)
                    .user_executable(true)
                    .insert(space);
            }
        }
        let reference = match node.relation {
            Relation::HasSubtype => ReferenceTypeId::HasSubtype,
            Relation::HasComponent => ReferenceTypeId::HasComponent,
            Relation::HasProperty => ReferenceTypeId::HasProperty,
            Relation::Organizes => ReferenceTypeId::Organizes,
        };
        space.insert_reference(&self.node_id(&node.parent), &id, reference);
        let rule = node.rule.map(|rule| match rule {
            Rule::Mandatory => MANDATORY,
            Rule::OptionalPlaceholder => OPTIONAL_PLACEHOLDER,
        });
        if let Some(rule) = rule {
            space.insert_reference(&id, &NodeId::new(0, rule), ReferenceTypeId::HasModellingRule);
        }
    }
}

fn variant(value: Value) -> Variant {
    match value {
        Value::Live => Variant::Empty,
        Value::Texts(texts) => {
            let texts: Vec<Variant> = texts.iter().map(|text| Variant::from(LocalizedText::from(*text))).collect();
            Variant::from((VariantScalarTypeId::LocalizedText, texts))
        }
        Value::Arguments(arguments) => {
            let object = |argument: &Argument| Variant::from(ExtensionObject::from_message(ua_argument(argument)));
            let objects: Vec<Variant> = arguments.iter().map(object).collect();
            Variant::from((VariantScalarTypeId::ExtensionObject, objects))
        }
    }
}

fn enum_fields(fields: &[&str]) -> Vec<EnumField> {
    let field = |(value, name): (usize, &&str)| EnumField {
        value: value as i64,
        display_name: LocalizedText::from(*name),
        description: LocalizedText::null(),
        name: UAString::from(*name),
    };
    fields.iter().enumerate().map(field).collect()
}

fn ua_argument(argument: &Argument) -> UaArgument {
    UaArgument {
        name: UAString::from(argument.name),
        data_type: NodeId::new(0, argument.data_type),
        value_rank: if argument.is_array { LIST } else { SCALAR },
        array_dimensions: argument.is_array.then(|| vec![0]),
        description: LocalizedText::from(argument.about),
    }
}
