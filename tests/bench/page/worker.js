// Asks how many rounds to measure, measures them and sends the report with the next question, until
// the answer is 0.
import init, { Bench } from './pkg/stepscope_bench.js';

const ask = async (report) => Number(await (await fetch('/rounds', { method: 'POST', body: report })).text());

try {
  await init();
  const bench = new Bench();
  for (let rounds = await ask(''); rounds > 0; ) {
    rounds = await ask(bench.rounds(rounds));
  }
} catch (error) {
  await fetch('/failed', { method: 'POST', body: String(error?.stack ?? error) });
}
