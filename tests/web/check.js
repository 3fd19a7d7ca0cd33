// Cases and what they require; closes with `N passed, N failed`.
'use strict';

let passed = 0;
let failed = 0;
const faults = [];
const MOST_SECONDS = 300;
process.exitCode = 1;  // until all of them have ended

function require_(what, got, wanted) {
  if (got !== wanted) faults.push(`${what} is ${JSON.stringify(got)}, wanted ${JSON.stringify(wanted)}`);
}
function holds(what, value) {
  if (!value) faults.push(`${what} does not hold`);
}
async function test(name, run) {
  faults.length = 0;
  let clock = null;
  const late = new Promise((_, fail) => {
    clock = setTimeout(() => fail(new Error(`it has not ended in ${MOST_SECONDS} s`)), 1000 * MOST_SECONDS);
  });
  try {
    await Promise.race([run(), late]);
  } catch (error) {
    faults.push(error.message);
  }
  clearTimeout(clock);
  if (faults.length === 0) {
    ++passed;
  } else {
    ++failed;
    console.error(`FAILED ${name}\n  ${faults.join('\n  ')}`);
  }
}
function end(title) {
  console.log(`test-web: ${title}`);
  console.log(`${passed} passed, ${failed} failed`);
  process.exitCode = failed === 0 && passed > 0 ? 0 : 1;
}

module.exports = {test, is: require_, holds, end};
