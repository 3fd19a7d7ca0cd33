// The kernels' text as WGSL, for pages: wgsl(name) of KERNELS. It knows the subset of GLSL and C++ that this text is in, with
// its types, and refuses what is beyond it: an operand of another type, a name that is unknown.
'use strict';
const fs = require('fs');
const path = require('path');

const LIT = {texts: ['parameters', 'numbers', 'picture', 'octree', 'optics', 'slope', 'light'], words: 'kParameterWords', run: 'lit_invocation'};
const KERNELS = {
  words: LIT,  // samples of a lit picture
  pairs: {...LIT, defined: ['PAIRS']},
  finish: {texts: ['parameters', 'finish'], words: 'kFinishWords', run: 'finish_invocation'},
};
const TYPES = {int: 'i32', uint: 'u32', bool: 'bool', ivec3: 'vec3<i32>', void: ''};
// Functions of GLSL: what they give, and how WGSL says it. None: what its first argument is.
const BUILT_IN = {
  abs: [null, 'abs(#)'], min: [null, 'min(#)'], max: [null, 'max(#)'], ivec3: ['ivec3', 'vec3<i32>(#)'],
  int: ['int', 'i32(#)'], uint: ['uint', 'u32(#)'], bitCount: ['int', 'i32(countOneBits(#))'],
  findMSB: ['int', 'i32(firstLeadingBit(#))'], findLSB: ['int', 'i32(firstTrailingBit(#))'],
  P: ['uint', 'parameter(#)'], S: ['uint', 'scene[#]'], R: ['uint', 'result[#]'],
};
const SIDES = [['||'], ['&&'], ['|'], ['^'], ['&'], ['==', '!='], ['<', '>', '<=', '>='], ['<<', '>>'], ['+', '-'], ['*', '/', '%']];
const before = ({words, run}) => `
@group(0) @binding(0) var<uniform> parameters: array<vec4<u32>, ${words}_ / 4>;
@group(0) @binding(1) var<storage, read> scene: array<u32>;
@group(0) @binding(2) var<storage, read_write> result: array<u32>;
fn parameter(i: i32) -> u32 { return parameters[i >> 2u][i & 3]; }
fn umulExtended_(a: u32, b: u32, hi: ptr<function, u32>, lo: ptr<function, u32>) {
  let x = (a & 65535u) * (b & 65535u);
  let y = (a >> 16u) * (b & 65535u) + (x >> 16u);
  let z = (a & 65535u) * (b >> 16u) + (y & 65535u);
  *hi = (a >> 16u) * (b >> 16u) + (y >> 16u) + (z >> 16u);
  *lo = a * b;
}
@compute @workgroup_size(8, 8) fn main(@builtin(global_invocation_id) at: vec3<u32>) { ${run}_(at.x, at.y); }
`;

// Its tokens, without what an #ifdef leaves out. Of defines it knows names of one word.
function tokensOf(text, defined) {
  const named = new Map();
  const taken = [];
  let kept = '';
  for (const line of text.split('\n')) {
    const [, word, name, meaning] = /^#(\w+) ?(\w*) ?(\w*)$/.exec(line) ?? [];
    if (word === 'ifdef') taken.push(defined.includes(name));
    else if (word === 'else') taken.push(!taken.pop());
    else if (word === 'endif') taken.pop();
    else if (line[0] === '#' && word !== 'define') throw new Error(`this directive is none of the kernel's: ${line}`);
    else if (taken.every(Boolean) && word === 'define') named.set(name, meaning);
    else if (taken.every(Boolean)) kept += `${line.replace(/\/\/.*/, '')}\n`;
  }
  return (kept.match(/0x\w+|\w+|<<=|>>=|[-+*/%&|^=!<>]=|&&|\|\||<<|>>|\+\+|--|[^\s\w]/g) ?? []).map((token) => named.get(token) ?? token);
}

class Translator {
  constructor(text, defined) {
    this.tokens = tokensOf(text, defined);
    this.at = 0;
    this.structs = new Map();    // name -> Map of members
    this.functions = new Map([['umulExtended', {type: 'void', parameters: ['uint', 'uint', '*uint', '*uint']}]]);
    this.scopes = [new Map()];   // name -> {type, pointer}
  }
  refuse(why) {
    throw new Error(`WGSL: ${why}, at: ${this.tokens.slice(Math.max(0, this.at - 8), this.at + 4).join(' ')}`);
  }
  peek(token) {
    return this.tokens[this.at] === token;
  }
  take(token) {
    if (!this.peek(token)) return false;
    ++this.at;
    return true;
  }
  want(token) {
    if (!this.take(token)) this.refuse(`${token} is missing`);
  }
  name() {
    const name = this.tokens[this.at++];
    if (!/^[A-Za-z_]\w*$/.test(name)) this.refuse('a name is missing');
    return name;
  }
  isType(token = this.tokens[this.at]) {
    return token in TYPES || this.structs.has(token);
  }
  type() {
    if (!this.isType()) this.refuse('a type is missing');
    return this.tokens[this.at++];
  }
  same(one, other) {
    if (one !== other) this.refuse(`${one} stands where ${other} is wanted`);
  }
  written(type) {
    const [, of, count] = /^(\w+)\[(.*)\]$/.exec(type) ?? [];
    return of ? `array<${this.written(of)}, ${count}>` : TYPES[type] ?? `${type}_`;
  }
  declare(name, type, pointer = false) {
    this.scopes[this.scopes.length - 1].set(name, {type, pointer});
  }
  find(name) {
    for (let i = this.scopes.length - 1; i >= 0; --i) if (this.scopes[i].has(name)) return this.scopes[i].get(name);
    return this.refuse(`${name} is unknown`);
  }

  // ---- expressions: {text, type, root: the variable that it names a part of, whole: or all, calls: 1 where it calls
  // functions of the text, 2 where they write, choice: the three parts of one}

  expression(wanted = null) {
    const made = this.either();
    if (wanted !== null) this.same(made.type, wanted);
    return made;
  }
  either() {
    const asked = this.binary(0);
    if (!this.take('?')) return asked;
    this.same(asked.type, 'bool');
    const one = this.either();
    this.want(':');
    const other = this.either();
    this.same(other.type, one.type);
    const calls = Math.max(asked.calls ?? 0, one.calls ?? 0, other.calls ?? 0);
    if (calls === 2) this.refuse('a choice writes');  // select works out both
    const refuse = () => this.refuse('a choice of structs within an expression');
    const isStruct = this.structs.has(one.type);
    const text = () => (isStruct ? refuse() : `select(${other.text}, ${one.text}, ${asked.text})`);
    return {get text() { return text(); }, type: one.type, calls, choice: [asked, one, other]};
  }
  // A statement that puts a value somewhere: of a choice only the part that is taken is worked out where that is long.
  put(made, where) {
    if (!this.branches(made)) return `${where(made.text)};\n`;
    const [asked, one, other] = made.choice;
    return `if (${asked.text}) {\n${this.put(one, where)}} else {\n${this.put(other, where)}}\n`;
  }
  branches({choice, calls, type}) {
    return choice && (calls || this.structs.has(type));
  }
  binary(level) {
    if (level === SIDES.length) return this.unary();
    let left = this.binary(level + 1);
    while (SIDES[level].includes(this.tokens[this.at])) {
      const sign = this.tokens[this.at++];
      const right = this.binary(level + 1);
      const calls = Math.max(left.calls ?? 0, right.calls ?? 0);
      let type = left.type;
      if (sign === '<<' || sign === '>>') {
        if (!/^u?int$/.test(left.type) || !/^u?int$/.test(right.type)) this.refuse('a shift of no integer');
        const by = /^\d+u?$/.test(right.bare) ? `${parseInt(right.bare, 10)}u` : `u32(${right.text})`;
        left = {text: `(${left.text} ${sign} ${by})`, type, calls};
        continue;
      }
      this.same(right.type, type);
      const isOfBools = sign === '&&' || sign === '||';
      if (isOfBools ? type !== 'bool' : /^(==|!=)$/.test(sign) ? !/^(u?int|bool)$/.test(type) : sign === '+' ? !/^(u?int|ivec3)$/.test(type) : !/^u?int$/.test(type)) {
        this.refuse(`${sign} of ${type}`);
      }
      if (/^([=!<>]=|<|>)$/.test(sign)) type = 'bool';
      left = {text: `(${left.text} ${sign} ${right.text})`, type, calls};
    }
    return left;
  }
  unary() {
    for (const [sign, types] of [['-', /^int$/], ['~', /^u?int$/], ['!', /^bool$/]]) {
      if (!this.take(sign)) continue;
      const of = this.unary();
      if (!types.test(of.type)) this.refuse(`${sign} of ${of.type}`);
      return {text: `${sign}(${of.text})`, type: of.type, calls: of.calls};
    }
    return this.postfix();
  }
  postfix() {
    let made = this.primary();
    for (;;) {
      if (this.take('.')) {
        const member = this.name();
        const type = made.type === 'ivec3' ? (/^[xyz]$/.test(member) ? 'int' : null) : this.structs.get(made.type)?.get(member);
        if (!type) this.refuse(`${made.type} has no ${member}`);
        made = {...made, text: `${made.text}.${member}${made.type === 'ivec3' ? '' : '_'}`, type, whole: false};
      } else if (this.take('[')) {
        const index = this.expression();
        this.want(']');
        const of = made.type === 'ivec3' ? 'int' : /^(\w+)\[/.exec(made.type)?.[1];
        if (!of || !/^u?int$/.test(index.type)) this.refuse('no array, or no index');
        made = {...made, text: `${made.text}[${index.text}]`, type: of, whole: false, calls: Math.max(made.calls ?? 0, index.calls ?? 0)};
      } else {
        return made;
      }
    }
  }
  primary() {
    if (this.take('(')) {
      const inner = this.expression();
      this.want(')');
      return {text: inner.text, type: inner.type, calls: inner.calls};
    }
    const token = this.tokens[this.at];
    if (/^\d/.test(token)) {
      ++this.at;
      if (!/^(0x[0-9A-Fa-f]+|\d+)u?$/.test(token)) this.refuse('no integer');
      return token.endsWith('u') ? {text: token, type: 'uint', bare: token} : {text: `${token}i`, type: 'int', bare: token};
    }
    if (token === 'true' || token === 'false') return ++this.at, {text: token, type: 'bool'};
    const name = token in BUILT_IN ? this.tokens[this.at++] : this.name();
    if (this.take('(')) return this.call(name);
    const {type, pointer} = this.find(name);
    return {text: pointer ? `(*${name}_)` : `${name}_`, type, root: name, whole: true};
  }
  call(name) {
    const {type, parameters, writes} = this.functions.get(name) ?? {parameters: null};
    const given = [];
    while (!this.take(')')) {
      if (given.length > 0) this.want(',');
      given.push(this.expression());
    }
    let calls = Math.max(writes ? 2 : 0, ...given.map((each) => each.calls ?? 0));
    this.writes ||= writes;
    if (parameters === null) {
      const [result, text] = BUILT_IN[name] ?? this.refuse(`${name} is unknown`);
      const of = {P: 'int', S: 'uint', R: 'uint', ivec3: 'int', bitCount: 'uint', findMSB: 'uint', findLSB: 'uint'}[name] ?? given[0].type;
      for (const each of given) this.same(each.type, of);
      if (!/^(u?int|bool)$/.test(of) || given.length !== (name === 'ivec3' ? 3 : /^m(in|ax)$/.test(name) ? 2 : 1)) this.refuse(`${name} gets others`);
      return {text: text.replace('#', () => given.map((each) => each.text).join(', ')), type: result ?? of, calls};
    }
    if (given.length !== parameters.length) this.refuse(`${name} gets ${given.length} arguments`);
    const texts = given.map((each, i) => {
      const of = parameters[i].replace('*', '');
      this.same(each.type, of);
      if (of === parameters[i]) return each.text;
      if (!each.whole) this.refuse(`${name} writes to a part`);  // WGSL points to whole variables alone
      calls = 2;
      this.assigned.add(each.root);
      return this.find(each.root).pointer ? `${each.root}_` : `&${each.root}_`;
    });
    return {text: `${name}_(${texts.join(', ')})`, type, calls: Math.max(calls, 1)};
  }

  // ---- statements

  // A declaration, an assignment or a call.
  simple() {
    if (this.isType() && this.tokens[this.at + 1] !== '(') {
      let type = this.type();
      const name = this.name();
      if (this.take('[')) {
        type += `[${this.expression('int').text}]`;
        this.want(']');
      }
      const value = this.take('=') ? this.expression(type) : null;
      this.declare(name, type);
      const variable = `var ${name}_: ${this.written(type)}`;
      if (value === null) return `${variable};\n`;
      return this.branches(value) ? `${variable};\n${this.put(value, (text) => `${name}_ = ${text}`)}` : `${variable} = ${value.text};\n`;
    }
    if (this.peek('++') || this.peek('--')) {
      const sign = this.tokens[this.at++];
      return `${this.target().text}${sign};\n`;
    }
    if (this.take('STORE')) {
      this.writes = true;
      this.want('(');
      const at = this.expression('uint').text;
      this.want(',');
      const value = this.expression('uint').text;
      this.want(')');
      return `result[${at}] = ${value};\n`;
    }
    const start = this.at;
    const left = this.postfix();
    const sign = this.tokens[this.at++];
    if (sign === ';') {
      --this.at;
      if (left.calls !== 2) this.refuse('a statement that does nothing');
      return `${left.type === 'void' ? '' : '_ = '}${left.text};\n`;
    }
    if (!/^([-+*/%&|^]|<<|>>)?=$/.test(sign)) this.refuse('no statement');
    this.at = start;
    const to = this.target();
    ++this.at;
    const right = this.expression();
    if (sign === '<<=' || sign === '>>=') return `${to.text} ${sign} u32(${right.text});\n`;
    this.same(right.type, to.type);
    return this.put(right, (text) => `${to.text} ${sign} ${text}`);
  }
  target() {
    const to = this.postfix();
    if (!to.root) this.refuse('no variable');
    this.assigned.add(to.root);
    this.writes ||= this.scopes[0].get(to.root) === this.find(to.root);
    return to;
  }
  block() {
    this.want('{');
    this.scopes.push(new Map());
    let text = '{\n';
    while (!this.take('}')) text += this.statement();
    this.scopes.pop();
    return `${text}}\n`;
  }
  condition() {
    this.want('(');
    const {text} = this.expression('bool');
    this.want(')');
    return text;
  }
  statement() {
    if (this.peek('{')) return this.block();
    if (this.take('if')) {
      const text = `if (${this.condition()}) ${this.block()}`;
      return this.take('else') ? `${text}else ${this.peek('if') ? this.statement() : this.block()}` : text;
    }
    if (this.take('while')) return `while (${this.condition()}) ${this.block()}`;
    if (this.take('for')) {
      this.want('(');
      this.scopes.push(new Map());
      const first = this.peek(';') ? ';\n' : this.part();
      this.want(';');
      const until = this.peek(';') ? '' : this.expression('bool').text;
      this.want(';');
      const then = this.peek(')') ? '' : this.part();
      this.want(')');
      const text = `for (${first.slice(0, -1)} ${until}; ${then.slice(0, -2)}) ${this.block()}`;
      this.scopes.pop();
      return text;
    }
    let text = null;
    if (this.take('return')) {
      text = this.peek(';') ? 'return;\n' : this.put(this.expression(this.returns), (value) => `return ${value}`);
    } else {
      text = this.peek('break') || this.peek('continue') ? `${this.tokens[this.at++]};\n` : this.simple();
    }
    this.want(';');
    return text;
  }
  // Of the head of a loop.
  part() {
    const text = this.simple();
    return /;\n./.test(text) ? this.refuse('a loop of more than one statement') : text;
  }
  // Parameters that are assigned become variables.
  fn() {
    const type = this.type();
    const name = this.name();
    const parameters = [];
    this.scopes.push(new Map());
    this.assigned = new Set();
    this.writes = false;  // beyond what it is given
    this.returns = type;
    this.want('(');
    while (!this.take(')')) {
      if (parameters.length > 0) this.want(',');
      const pointer = this.take('OUT') || this.take('INOUT');
      if (pointer) this.want('(');
      const of = this.type();
      if (pointer) this.want(')');
      const called = this.name();
      parameters.push({of, pointer, called});
      this.declare(called, of, pointer);
    }
    this.functions.set(name, {type, parameters: parameters.map(({of, pointer}) => (pointer ? '*' : '') + of)});
    const body = this.block();
    this.scopes.pop();
    this.functions.get(name).writes = this.writes;
    const changed = parameters.filter(({pointer, called}) => !pointer && this.assigned.has(called));
    const list = parameters.map((each) => `${each.called}_${changed.includes(each) ? 'in' : ''}: ` +
      (each.pointer ? `ptr<function, ${this.written(each.of)}>` : this.written(each.of)));
    return `fn ${name}_(${list.join(', ')})${type === 'void' ? '' : ` -> ${this.written(type)}`} {\n` +
      `${changed.map(({called, of}) => `var ${called}_: ${this.written(of)} = ${called}_in;\n`).join('')}${body.slice(2)}`;
  }
  struct() {
    const name = this.name();
    const members = new Map();
    this.want('{');
    while (!this.take('}')) {
      const type = this.type();
      members.set(this.name(), type);
      this.want(';');
    }
    this.want(';');
    this.structs.set(name, members);
    return `struct ${name}_ {\n${[...members].map(([member, type]) => `${member}_: ${this.written(type)},\n`).join('')}}\n`;
  }
  // A constant, or a variable of each invocation.
  global(isConstant) {
    let type = this.type();
    const name = this.name();
    if (this.take('[')) {
      type += `[${this.expression('int').text}]`;
      this.want(']');
    }
    this.declare(name, type);
    const value = isConstant ? (this.want('='), ` = ${this.expression(type).text}`) : '';
    this.want(';');
    return `${isConstant ? 'const' : 'var<private>'} ${name}_: ${this.written(type)}${value};\n`;
  }
  all() {
    let text = '';
    while (this.at < this.tokens.length) {
      text += this.take('struct') ? this.struct() : this.take('FN') ? this.fn() : this.global(this.take('const'));
    }
    return text;
  }
}
const translate = (text, defined = []) => new Translator(text, defined).all();
function wgsl(name) {
  const kernel = KERNELS[name];
  return before(kernel).slice(1) + translate(kernel.texts.map((text) => fs.readFileSync(path.join(__dirname, `${text}.inc`), 'utf8')).join(''), kernel.defined);
}
module.exports = {KERNELS, translate, wgsl};
