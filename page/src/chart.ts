// A uPlot chart that fills its host, follows its size, and is set up anew when theme or type size changes.
import uPlot from 'uplot';
import { fixed } from './format';
import { look, type Look } from './look';

type Options = Omit<uPlot.Options, 'width' | 'height'>;
const charts = new Set<Chart>();

export class Chart {
  plot: uPlot;
  private rem = look().rem;

  constructor(
    private readonly host: HTMLElement,
    private readonly options: (look: Look) => Options,
    private data: uPlot.AlignedData,
  ) {
    this.plot = this.make();
    charts.add(this);
    new ResizeObserver(() => this.resize()).observe(host);
  }

  show(data: uPlot.AlignedData): void {
    this.data = data;
    this.plot.setData(data);
  }

  /** Draws again what is beside the data: marks, colours. */
  redraw(): void {
    this.plot.redraw(false, true);
  }

  rebuild(): void {
    this.plot.destroy();
    this.rem = look().rem;
    this.plot = this.make();
  }

  private make(): uPlot {
    return new uPlot({ ...this.options(look()), ...this.size() }, this.data, this.host);
  }

  private size(): { width: number; height: number } {
    return { width: Math.max(this.host.clientWidth, 50), height: Math.max(this.host.clientHeight, 50) };
  }

  private resize(): void {
    if (look().rem !== this.rem) this.rebuild();
    else this.plot.setSize(this.size());
  }
}

/** The digits that tell one tick from the next. */
function decimals(splits: number[]): number {
  const step = Math.abs((splits[1] ?? 1) - (splits[0] ?? 0));
  const told = (digits: number): boolean => Math.abs(step - Number(step.toFixed(digits))) < 1e-6 * step;
  return [0, 1, 2, 3].find(told) ?? 4;
}

export function rebuildCharts(): void {
  for (const chart of charts) chart.rebuild();
}

/** An axis in the page's style. `label` names quantity and unit. */
function axis(look: Look, label: string, more: uPlot.Axis = {}): uPlot.Axis {
  return {
    stroke: look.muted,
    font: look.font,
    labelFont: look.font,
    label,
    labelSize: 1.4 * look.rem,
    labelGap: 0,
    gap: 4,
    values: (_, splits) => splits.map((v) => fixed(v, decimals(splits))),
    ...more,
    grid: { stroke: look.line, width: 1, ...more.grid },
    ticks: { stroke: look.line, width: 1, size: 4, ...more.ticks },
  };
}

/** Width of every vertical axis in root ems, label included: charts below each other line up. */
export const sideEms = 5.1;
/** Room at a chart's right, for half a label. */
export const rightEms = 1.6;

export function sideAxis(look: Look, label: string, more: uPlot.Axis = {}): uPlot.Axis {
  return axis(look, label, { size: (sideEms - 1.4) * look.rem, space: 2 * look.rem, ...more });
}

export function bottomAxis(look: Look, label: string, more: uPlot.Axis = {}): uPlot.Axis {
  return axis(look, label, { size: 1.7 * look.rem, space: 4 * look.rem, ...more });
}

/** What is the same in all charts: no legend (captions are HTML), a line under the pointer only where it is read. */
export const plain: Pick<Options, 'legend' | 'cursor' | 'select'> = {
  legend: { show: false },
  cursor: { show: false },
};
