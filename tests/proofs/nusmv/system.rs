//! A model as variables, their first values and what may follow: modules put in the place of their
//! instances, names looked up, definitions put in the place of their names.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt;

use super::syntax::{Binary, Branching, Expression, Module, Type};

/// What a variable may be; a symbol is its place in the list of all symbols.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) enum Value {
    Truth(bool),
    Number(i64),
    Symbol(usize),
}

/// An expression with all names looked up.
#[derive(Clone, Debug)]
pub(super) enum Term {
    Variable(usize),
    /// What a variable will be.
    Next(usize),
    Constant(Value),
    Not(Box<Term>),
    Binary(Binary, Box<Term>, Box<Term>),
    Case(Vec<(Term, Term)>),
    Set(Vec<Term>),
    Branching(Branching, Box<Term>),
    ExistsUntil(Box<Term>, Box<Term>),
}

/// What is wrong with a model.
#[derive(Debug)]
pub(super) struct ModelError(String);

impl fmt::Display for ModelError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

#[derive(Debug)]
struct Variable {
    name: String,
    domain: BTreeSet<Value>,
    init: Option<Term>,
    next: Option<Term>,
}

/// A module in the place of an instance.
struct Scope<'m> {
    module: &'m Module,
    /// The instance's path with a point behind it; empty for `main`.
    prefix: String,
    /// What its parameters stand for, and in which scope.
    given: Vec<(&'m Expression, usize)>,
    instances: BTreeMap<&'m str, usize>,
}

/// A model that can be run.
#[derive(Debug)]
pub(super) struct System {
    variables: Vec<Variable>,
    /// The variables in an order in which each needs only what comes before it.
    order: Vec<usize>,
    symbols: Vec<String>,
    pub(super) specifications: Vec<(String, Term)>,
}

struct Builder<'m> {
    modules: &'m [Module],
    scopes: Vec<Scope<'m>>,
    variables: Vec<Variable>,
    symbols: Vec<String>,
}

impl System {
    pub(super) fn new(modules: &[Module]) -> Result<Self, ModelError> {
        let mut builder = Builder { modules, scopes: Vec::new(), variables: Vec::new(), symbols: Vec::new() };
        builder.instantiate("main", "", Vec::new())?;
        let mut specifications = Vec::new();
        for index in 0..builder.scopes.len() {
            let (module, prefix) = (builder.scopes[index].module, builder.scopes[index].prefix.clone());
            for (name, value) in &module.inits {
                let term = builder.term(value, index, false)?;
                builder.variable(&format!("{prefix}{name}"))?.init = Some(term);
            }
            for (name, value) in &module.nexts {
                let term = builder.term(value, index, false)?;
                builder.variable(&format!("{prefix}{name}"))?.next = Some(term);
            }
            for (text, claim) in &module.specifications {
                specifications.push((text.clone(), builder.term(claim, index, false)?));
            }
        }
        for Variable { name, init, next, .. } in &builder.variables {
            if init.is_none() {
                return Err(ModelError(format!("nothing says what `{name}` is at first")));
            }
            if next.is_none() {
                return Err(ModelError(format!("nothing says what follows of `{name}`")));
            }
        }
        let order = order(&builder.variables)?;
        Ok(Self { variables: builder.variables, order, symbols: builder.symbols, specifications })
    }

    /// The value of a variable of this name, as text.
    pub(super) fn shown(&self, state: &[Value], name: &str) -> String {
        let at = self.variables.iter().position(|variable| variable.name == name).expect("a variable");
        match state[at] {
            Value::Truth(truth) => truth.to_string(),
            Value::Number(number) => number.to_string(),
            Value::Symbol(symbol) => self.symbols[symbol].clone(),
        }
    }

    /// The states in which a model may begin.
    pub(super) fn first(&self) -> Vec<Vec<Value>> {
        let all: Vec<usize> = (0..self.variables.len()).collect();
        self.assigned(&all, &[], |variable| variable.init.as_ref())
    }

    /// The states that may follow.
    pub(super) fn after(&self, state: &[Value]) -> Vec<Vec<Value>> {
        self.assigned(&self.order, state, |variable| variable.next.as_ref())
    }

    /// Each way of giving every variable one of the values that it may have, in this order.
    fn assigned(&self, order: &[usize], state: &[Value], rule: fn(&Variable) -> Option<&Term>) -> Vec<Vec<Value>> {
        let mut partial = vec![vec![Value::Truth(false); self.variables.len()]];
        for at in order {
            let Variable { name, domain, .. } = &self.variables[*at];
            let rule = rule(&self.variables[*at]).expect("checked when it was built");
            let mut longer = Vec::new();
            for next in partial {
                for value in values(rule, state, &next) {
                    assert!(domain.contains(&value), "{name} := {value:?}, which it cannot be");
                    let mut with = next.clone();
                    with[*at] = value;
                    longer.push(with);
                }
            }
            partial = longer;
        }
        partial
    }
}

impl<'m> Builder<'m> {
    /// Puts a module in the place of an instance, and the modules of its own instances.
    fn instantiate(
        &mut self,
        name: &str,
        prefix: &str,
        given: Vec<(&'m Expression, usize)>,
    ) -> Result<usize, ModelError> {
        let module = self.modules.iter().find(|module| module.name == name);
        let module = module.ok_or_else(|| ModelError(format!("there is no module `{name}`")))?;
        if module.parameters.len() != given.len() {
            return Err(ModelError(format!("`{name}` has {} parameters", module.parameters.len())));
        }
        let index = self.scopes.len();
        self.scopes.push(Scope { module, prefix: prefix.to_owned(), given, instances: BTreeMap::new() });
        for (name, ty) in &module.variables {
            let path = format!("{prefix}{name}");
            let domain = match ty {
                Type::Boolean => [false, true].map(Value::Truth).into(),
                Type::Range(low, high) => (*low..=*high).map(Value::Number).collect(),
                Type::Symbols(all) => all.iter().map(|symbol| self.symbol(symbol)).collect(),
                Type::Instance(of, given) => {
                    let given = given.iter().map(|expression| (expression, index)).collect();
                    let instance = self.instantiate(of, &format!("{path}."), given)?;
                    self.scopes[index].instances.insert(name, instance);
                    continue;
                }
            };
            self.variables.push(Variable { name: path, domain, init: None, next: None });
        }
        Ok(index)
    }

    fn symbol(&mut self, name: &str) -> Value {
        let known = self.symbols.iter().position(|known| known == name);
        Value::Symbol(known.unwrap_or_else(|| {
            self.symbols.push(name.to_owned());
            self.symbols.len() - 1
        }))
    }

    fn variable(&mut self, name: &str) -> Result<&mut Variable, ModelError> {
        let found = self.variables.iter_mut().find(|variable| variable.name == name);
        found.ok_or_else(|| ModelError(format!("there is no variable `{name}`")))
    }

    fn term(&self, expression: &Expression, scope: usize, of_next: bool) -> Result<Term, ModelError> {
        let inner = |expression: &Expression| self.term(expression, scope, of_next).map(Box::new);
        Ok(match expression {
            Expression::Truth(truth) => Term::Constant(Value::Truth(*truth)),
            Expression::Number(number) => Term::Constant(Value::Number(*number)),
            Expression::Not(of) => Term::Not(inner(of)?),
            Expression::Binary(binary, left, right) => Term::Binary(*binary, inner(left)?, inner(right)?),
            Expression::Next(of) => self.term(of, scope, true)?,
            Expression::Branching(branching, of) => Term::Branching(*branching, inner(of)?),
            Expression::ExistsUntil(hold, until) => Term::ExistsUntil(inner(hold)?, inner(until)?),
            Expression::Set(all) => {
                Term::Set(all.iter().map(|one| self.term(one, scope, of_next)).collect::<Result<_, _>>()?)
            }
            Expression::Case(arms) => {
                let arm = |(condition, value): &(Expression, Expression)| {
                    Ok((self.term(condition, scope, of_next)?, self.term(value, scope, of_next)?))
                };
                Term::Case(arms.iter().map(arm).collect::<Result<_, _>>()?)
            }
            Expression::Name(path) => self.named(path, scope, of_next)?,
        })
    }

    fn named(&self, path: &[String], scope: usize, of_next: bool) -> Result<Term, ModelError> {
        let Scope { module, prefix, given, instances } = &self.scopes[scope];
        let [name, rest @ ..] = path else { return Err(ModelError("a name without letters".to_owned())) };
        if let Some(instance) = instances.get(name.as_str()) {
            return self.named(rest, *instance, of_next);
        }
        if let Some(at) = module.parameters.iter().position(|parameter| parameter == name) {
            let (expression, of) = given[at];
            return self.term(expression, of, of_next);
        }
        if let Some((_, meaning)) = module.defines.iter().find(|(define, _)| define == name) {
            return self.term(meaning, scope, of_next);
        }
        let path = format!("{prefix}{name}");
        if let Some(at) = self.variables.iter().position(|variable| variable.name == path) {
            return Ok(if of_next { Term::Next(at) } else { Term::Variable(at) });
        }
        let symbol = self.symbols.iter().position(|symbol| symbol == name);
        symbol
            .map(|symbol| Term::Constant(Value::Symbol(symbol)))
            .ok_or_else(|| ModelError(format!("nothing is called `{path}`")))
    }
}

/// The variables in an order in which each needs only what comes before it.
fn order(variables: &[Variable]) -> Result<Vec<usize>, ModelError> {
    let mut needs: Vec<BTreeSet<usize>> = vec![BTreeSet::new(); variables.len()];
    for (variable, needs) in variables.iter().zip(&mut needs) {
        variable.next.iter().for_each(|term| gather(term, needs));
    }
    let mut order: Vec<usize> = Vec::new();
    while order.len() < variables.len() {
        let ready = (0..variables.len())
            .find(|at| !order.contains(at) && needs[*at].iter().all(|needed| order.contains(needed)));
        order.push(ready.ok_or_else(|| ModelError("what follows depends on itself".to_owned()))?);
    }
    Ok(order)
}

fn gather(term: &Term, needs: &mut BTreeSet<usize>) {
    match term {
        Term::Next(at) => {
            needs.insert(*at);
        }
        Term::Variable(_) | Term::Constant(_) => {}
        Term::Not(of) | Term::Branching(_, of) => gather(of, needs),
        Term::Binary(_, left, right) | Term::ExistsUntil(left, right) => {
            gather(left, needs);
            gather(right, needs);
        }
        Term::Set(all) => all.iter().for_each(|one| gather(one, needs)),
        Term::Case(arms) => arms.iter().for_each(|(condition, value)| {
            gather(condition, needs);
            gather(value, needs);
        }),
    }
}

/// The values that a term may have.
fn values(term: &Term, state: &[Value], next: &[Value]) -> Vec<Value> {
    match term {
        Term::Set(all) => all.iter().flat_map(|one| values(one, state, next)).collect(),
        Term::Case(arms) => {
            let arm = arms.iter().find(|(condition, _)| is_true(condition, state, next));
            values(&arm.expect("cases are exhaustive").1, state, next)
        }
        _ => vec![value(term, state, next)],
    }
}

fn is_true(term: &Term, state: &[Value], next: &[Value]) -> bool {
    value(term, state, next) == Value::Truth(true)
}

/// True if a term of the present holds in a state.
pub(super) fn holds(term: &Term, state: &[Value]) -> bool {
    is_true(term, state, &[])
}

fn value(term: &Term, state: &[Value], next: &[Value]) -> Value {
    match term {
        Term::Variable(at) => state[*at],
        Term::Next(at) => next[*at],
        Term::Constant(constant) => *constant,
        Term::Not(of) => Value::Truth(!is_true(of, state, next)),
        Term::Binary(binary, left, right) => {
            let (left, right) = (|| value(left, state, next), || value(right, state, next));
            let yes = Value::Truth(true);
            match binary {
                Binary::And => Value::Truth(left() == yes && right() == yes),
                Binary::Or => Value::Truth(left() == yes || right() == yes),
                Binary::Implies => Value::Truth(left() != yes || right() == yes),
                Binary::Equal => Value::Truth(left() == right()),
                Binary::Unequal => Value::Truth(left() != right()),
                Binary::Plus | Binary::Minus => match (left(), right()) {
                    (Value::Number(a), Value::Number(b)) => {
                        Value::Number(if *binary == Binary::Plus { a + b } else { a - b })
                    }
                    other => panic!("a sum of {other:?}"),
                },
            }
        }
        Term::Case(_) | Term::Set(_) => {
            let all = values(term, state, next);
            assert_eq!(all.len(), 1, "a choice stands where one value is needed");
            all[0]
        }
        Term::Branching(..) | Term::ExistsUntil(..) => panic!("branching time in a state"),
    }
}
